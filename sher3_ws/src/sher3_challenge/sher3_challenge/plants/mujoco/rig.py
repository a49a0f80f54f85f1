"""One robot in one run, as data that faults change: axes, host, mechanism, what yields, force sensor."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from sher3_description import Robot

from sher3_challenge.plants.grammar import NOTHING, Foreign
from sher3_challenge.plants.mujoco.axes.parts import AXES, Array, Axis, Bristle, Host


@dataclass
class Mechanism:
    """Six links on three rails, arm and tilt linkage, as built; metres and radians."""

    rail_ball: Array  # (6, 3) carriage balls at zero travel, {b}
    rail: Array  # (3, 3) directions of the rails
    platform_ball: Array  # (6, 3) in {p}
    link: Array  # (6,)
    arm: Array  # d1 d2 d3 tool_x tool_y tool_z
    linkage: Array  # crank coupler offset
    base_turn: Array = field(default_factory=lambda: np.zeros(3))
    base_shift: Array = field(default_factory=lambda: np.zeros(3))
    expansion: float = 0.0

    @property
    def linkage_zero(self) -> float:
        """Distance from slider to axis at zero tilt, where the axis is homed."""
        crank, coupler, offset = self.linkage
        return float(np.sqrt(coupler**2 - (offset - crank) ** 2))


@dataclass(frozen=True)
class Spring:
    """One way in which the structure gives way: a mass on a spring that also rubs.

    Attributes:
        way: what drives and what moves: `x`, `turn_y`, `turn_z` at P; `across_x`, `across_y` at the tool; `mode_y`,
            `mode_z` under the tip's acceleration.
        compliance: displacement per force.
        frequency: of the mass on the spring [Hz].
        damping: share of the critical one.
        rub: friction, in the unit of the driving force.
    """

    way: str
    compliance: float
    frequency: float = 45.0
    damping: float = 0.2
    rub: float = 0.0


@dataclass
class Yielding:
    """What gives way under load: springs moved by MuJoCo, the links' own law, and the small share of a healthy arm."""

    springs: tuple[Spring, ...] = ()
    links: float = 0.0
    healthy: float = 0.0
    slope: float = 0.0  # turn of the tool per deflection [rad/m]


@dataclass
class Sensor:
    """The force sensor and what is fixed to it."""

    matrix: Array
    bias: Array
    drift: Array
    tool_mass: float
    tool_com: Array
    cable: Array = field(default_factory=lambda: np.zeros(2))  # N per rad of roll and of tilt
    cable_bristles: tuple[Bristle, ...] = ()
    late: Array = field(default_factory=lambda: np.zeros(6))  # s, of every channel


@dataclass
class Rig:
    """Everything a fault may change; `region` is where the runs work."""

    robot: Robot
    axes: list[Axis]
    host: Host
    mechanism: Mechanism
    yielding: Yielding
    sensor: Sensor
    region: Array = field(default_factory=lambda: np.zeros(AXES))
    known_load: float = 1.0
    foreign: Foreign = NOTHING
