"""How fast the tip may be: two regimes with a travel budget each, and the bench, where nobody is near the tool.

`near_tissue` and `free` cap the tip's speed in every mode; their caps follow from the stop times (docs/safety.md,
`sher3_safety.budget`). `bench` has no cap but the actuators' own, for excitations and calibration; it is chosen at the
start and never while running.
"""

from __future__ import annotations

import math
from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_kinematics import RobotKinematics
from sher3_kinematics.arrays import unpack
from sher3_kinematics.kernel import tip_jacobian_into

from .compiled import compiled
from .errors import SettingsError
from .settings import MotionSettings

Array = NDArray[np.float64]
PLANNED = 0.8
"""Share of the cap that planned moves use; the host law's corrections need the rest."""
ROUNDING = 1.001
"""A speed counts as above the cap from this multiple on."""


class Regime(str, Enum):
    """What is near the tool."""

    NEAR_TISSUE = "near_tissue"
    FREE = "free"
    BENCH = "bench"


class SpeedCap(NamedTuple):
    """Largest tip speed [m/s] and turning [rad/s]; infinite on the bench."""

    linear: float
    angular: float


def speed_cap(settings: MotionSettings, regime: Regime) -> SpeedCap:
    """Return the caps of a regime."""
    if regime is Regime.BENCH:
        return SpeedCap(math.inf, math.inf)
    if regime is Regime.FREE:
        return SpeedCap(settings.free_speed, settings.free_turning)
    return SpeedCap(settings.near_speed, settings.near_turning)


@compiled
def cap_factor(parameters: Array, q: tuple[float, ...], velocity: tuple[float, ...], cap: tuple[float, float]) -> float:
    """Return what to scale an actuator velocity (5,) at `q` (5,) by so that the tip keeps the caps; 1 or less.

    `parameters` are the kernel parameters as an array (44,).
    """
    jacobian = np.empty((6, 5))
    tip_jacobian_into(unpack(parameters), np.array(q), jacobian)
    squares = np.zeros(2)
    for row in range(6):
        x = 0.0
        for k in range(5):
            x += jacobian[row, k] * velocity[k]
        squares[row // 3] += x * x
    factor = 1.0
    for part in range(2):
        speed = math.sqrt(squares[part])
        if speed > ROUNDING * cap[part]:
            factor = min(factor, cap[part] / speed)
    return factor


def planned_share(kinematics: RobotKinematics, start: Array, goal: Array, velocity: Array, cap: SpeedCap) -> float:
    """Return the share of the actuators' velocity caps (5,) at which a straight move keeps `PLANNED` of the cap."""
    way = goal - start
    if not np.any(way) or math.isinf(cap.linear):
        return 1.0
    tip = np.array([kinematics.jacobian(start + s * way) @ way for s in np.linspace(0.0, 1.0, 17)])
    longest = max(
        np.linalg.norm(tip[:, :3], axis=1).max() / cap.linear, np.linalg.norm(tip[:, 3:], axis=1).max() / cap.angular
    )
    moved = np.abs(way) > 1e-12
    fastest = float((velocity[moved] / np.abs(way[moved])).min())
    return min(1.0, PLANNED / (float(longest) * fastest)) if longest > 0.0 else 1.0


def parse_regime(text: str, present: Regime, moving: bool) -> Regime:
    """Return the regime that `regime NAME` asks for.

    Raises:
        SettingsError: unknown, from or to the bench, or a faster one while a motion mode owns the robot.
    """
    name = text.partition(" ")[2].strip()
    choices = [Regime.NEAR_TISSUE, Regime.FREE]
    if name not in [regime.value for regime in choices] or present is Regime.BENCH:
        known = ", ".join(regime.value for regime in choices)
        remedy = "send one of these; bench is chosen at the start, and left by a start without it"
        raise SettingsError(f"regime cannot change from {present.value}", value=name, limit=known, remedy=remedy)
    if name == Regime.FREE.value and moving:
        raise SettingsError("the regime cannot become free while the robot is in use", remedy="release the pedal")
    return Regime(name)
