"""What an axis of the plant is built of, as data: `model` makes MuJoCo's XML of it, `loop` moves it.

Values are in the unit of the actuator: m, N, kg on the sliders; rad, N m, kg m^2 on roll. Zero means absent.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sher3_challenge.plants.grammar import NOTHING, Foreign
from sher3_challenge.plants.level import EXACT, Bend
from sher3_challenge.plants.mujoco.axes.wheels import Eccentric

Array = NDArray[np.floating[Any]]
AXES = 5
ROLL, TILT = 3, 4

Law = Callable[[float, float, float], float]
"""A force [N] or a share of it at position, velocity and time; a frozen dataclass, so that a run can be told apart."""

ELEMENTS = ((0.6, 0.6), (0.4, 1.6))
"""Share of the force and relative reach of the two bristles that stand for one gradual friction.

The shares times the reaches add up to one: the loop has the area of the contract's exponential law.
"""

NO_BEND = EXACT.bend(0)
RUBBER_SOFT = 0.9
"""Share of a rubber coupling's softness that comes with time."""


@dataclass(frozen=True)
class Bristle:
    """A spring that drags a light body over rough ground: friction that builds up over `reach`, then slides."""

    force: float
    reach: float


@dataclass(frozen=True)
class Rider:
    """Bodies, tendons and contacts of an outside fault, as MJCF text.

    Attributes:
        carried: elements inside the slider's body.
        ground: elements of the world.
        tendons: elements of the section `tendon`.
        read: joints whose position the load encoder sees on top, with their share.
    """

    carried: str = ""
    ground: str = ""
    tendons: str = ""
    read: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Drive:
    """A drive that is not the contract's; MuJoCo's own actuator gives way to a law called at every substep.

    Attributes:
        limit: largest force.
        lag: delay of the force at low frequency [s], of a filter with two poles.
        droop: share of the force lost per unit of heat; heat is what force^2 leaves behind over `cooling` [s].
        cooling: time constant of the heat.
        rated: force whose square heats by one.
    """

    limit: float = math.inf
    lag: float = 0.0
    droop: float = 0.0
    cooling: float = 2.0
    rated: float = 1.0


@dataclass
class Axis:
    """One axis: motor side, transmission, load side.

    Attributes:
        kind: `prismatic` or `revolute`.
        mass, viscous, kp, ki, rated, lead: of the robot's description, as built.
        torque_gain, gravity_gain: real force over reported, real weight over modelled.
        constant: force against the positive direction.
        coulomb: dry friction of the motor's joint.
        levels: friction on top of it, by position, velocity and time.
        pushes: forces by position, velocity and time.
        payload: mass of a body on the slider; where it `hangs` its weight pulls along the slider.
        bristles: friction that builds up gradually.
        spring, spring_rest: stiffness of a tendon to the ground and where it is slack.
        drive: a law of its own; None is the contract's.
        deadband: demands below it do nothing.
        lead_error, ripples: load over motor less one; wheels off their centre between them.
        gap: width of the play between motor and load.
        windup, windup_reach: half width of lost motion that builds up, and over which travel.
        compliance, load_share: of the spring between motor and load, and the share of the mass behind it.
        rubber, rubber_time: compliance of a coupling that creeps, and its time constant.
        leg_gap: width of the play behind the load encoder.
        riders: what else is mounted.
    """

    kind: str
    mass: float
    viscous: float
    kp: float
    ki: float
    rated: float
    lead: float
    torque_gain: float = 1.0
    gravity_gain: float = 1.0
    constant: float = 0.0
    coulomb: float = 0.0
    levels: tuple[Law, ...] = ()
    pushes: tuple[Law, ...] = ()
    payload: float = 0.0
    hangs: bool = False
    bristles: tuple[Bristle, ...] = ()
    spring: float = 0.0
    spring_rest: float = 0.0
    drive: Drive | None = None
    deadband: float = 0.0
    lead_error: float = 0.0
    ripples: tuple[Eccentric, ...] = ()
    gap: float = 0.0
    windup: float = 0.0
    windup_reach: float = 1.0
    compliance: float = 0.0
    load_share: float = 0.25
    rubber: float = 0.0
    rubber_time: float = 0.3
    leg_gap: float = 0.0
    riders: tuple[Rider, ...] = ()

    @property
    def feather(self) -> float:
        """Mass of a body in a gap: its friction holds it at the largest accelerations."""
        return 5e-4 * self.mass

    @property
    def rub(self) -> float:
        """Friction that holds a body in its gap: half the floor of the motor's mechanics."""
        return 4e-4 * self.rated

    @property
    def heavy(self) -> bool:
        """Whether the load is behind a spring and carries its share of the mass."""
        return self.compliance > 0.0 or self.rubber > 0.0


@dataclass
class Host:
    """Host, transport and encoders; arrays are (5,).

    Attributes:
        gain, velocity_limit: of the position loop.
        motor_resolution, load_resolution: counts of the encoders; zeros are exact.
        offset: what both encoders read too much; `start`: how far from the first set-point a run begins.
        edge: where the edges of the encoders' counts are, in counts.
        encoder_scale, discs: ratio error and eccentric discs of load encoders, by axis.
        delay, jitter, loss: lateness of commands [s], its half-normal spread [s], probability of a loss.
        smoothing: time constant of a filter on the commands [s].
        bend: by which factors the laws of the axes differ; `foreign`: a law that no page has.
        hold: ticks from one demand that the drive takes to the next.
    """

    gain: Array
    velocity_limit: Array
    motor_resolution: Array
    load_resolution: Array
    offset: Array = field(default_factory=lambda: np.zeros(AXES))
    start: Array = field(default_factory=lambda: np.zeros(AXES))
    edge: Array = field(default_factory=lambda: np.zeros(AXES))
    encoder_scale: Array = field(default_factory=lambda: np.zeros(AXES))
    discs: dict[int, Eccentric] = field(default_factory=dict)
    delay: Array = field(default_factory=lambda: np.zeros(AXES))
    jitter: float = 0.0
    loss: float = 0.0
    bend: Bend = NO_BEND
    foreign: Foreign = NOTHING
    smoothing: Array = field(default_factory=lambda: np.zeros(AXES))
    hold: Array = field(default_factory=lambda: np.ones(AXES))
