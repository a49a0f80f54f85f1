"""How fast the tip may move: two regimes with a travel budget each, and the bench, where nobody is near the tool.

`near_tissue` and `free` cap the speed of the tip in every mode. Their caps follow from the time that a stop takes
(docs/reference/travel.md, `sher3_faults.budget`). `bench` knows no cap but those of the actuators; it is for
excitations and calibration, and is chosen at the start, never while the robot runs.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import compiled
from sher3_common.vectors import Vector
from sher3_kinematics import RobotKinematics

from sher3_control.errors import SettingsError
from sher3_control.motion.pose import tip_twist_sample
from sher3_control.settings import MotionSettings

Array = NDArray[np.float64]
PLANNED = 0.8
"""Share of the cap that planned moves use; the corrections of the host law need the rest."""
ROUNDING = 1.001
"""A speed counts as above the cap from this multiple of it on, so that a velocity scaled to the cap passes again."""
PLACES = 17
"""Places along a straight move, ends included, at which the tip's speed is looked at."""
STILL = 1e-12
"""An actuator that moves by no more than this [m or rad], which is rounding, is at rest."""


class Regime(str, Enum):
    """What is near the tool; the value is the text on `command/regime`."""

    NEAR_TISSUE = "near_tissue"
    FREE = "free"
    BENCH = "bench"


class SpeedCap(NamedTuple):
    """Largest speed of the tip [m/s] and largest rate of turning [rad/s]; infinite on the bench."""

    linear: float
    angular: float


def speed_cap(settings: MotionSettings, regime: Regime) -> SpeedCap:
    """Return the caps of a regime."""
    if regime is Regime.BENCH:
        return SpeedCap(math.inf, math.inf)
    if regime is Regime.FREE:
        return SpeedCap(settings.free_speed, settings.free_turning)
    return SpeedCap(settings.near_speed, settings.near_turning)


def axis_caps(settings: MotionSettings, cap: SpeedCap, limits: Sequence[float]) -> Vector:
    """Return the largest speed of every actuator (5,) [m/s, rad/s] under the caps of the tip, at most its own limit.

    The drives hold these caps too (object 0x6080), so that one which does not obey is no faster than its regime.

    Args:
        settings: how fast an actuator may be for a speed of the tip.
        cap: caps of the tip; infinite on the bench.
        limits: velocity limits of the actuators (5,).
    """
    leg, tilt = settings.leg_share * cap.linear, settings.tilt_arm * cap.angular
    return tuple(map(min, limits, (leg, leg, leg, cap.angular, tilt)))


@compiled
def cap_factor(parameters: Array, q: tuple[float, ...], velocity: tuple[float, ...], cap: tuple[float, float]) -> float:
    """Return the factor, 1 or less, that brings an actuator velocity within the caps of the tip.

    Args:
        parameters: kernel parameters as an array (44,).
        q: actuator positions (5,).
        velocity: of the actuators (5,).
        cap: tip speed [m/s] and turning [rad/s].
    """
    twist, squares = tip_twist_sample(parameters, q, velocity), np.zeros(2)
    for row in range(6):
        squares[row // 3] += twist[row] * twist[row]
    factor = 1.0
    for part in range(2):
        speed = math.sqrt(squares[part])
        if speed > ROUNDING * cap[part]:
            factor = min(factor, cap[part] / speed)
    return factor


def planned_share(kinematics: RobotKinematics, start: Array, goal: Array, velocity: Array, cap: SpeedCap) -> float:
    """Return the share of the actuators' velocity caps at which a straight move keeps `PLANNED` of the tip's caps.

    Args:
        kinematics: of the robot.
        start: actuator positions (5,).
        goal: actuator positions (5,).
        velocity: caps of the actuators (5,).
        cap: caps of the tip.
    """
    path = goal - start
    if not np.any(path) or math.isinf(cap.linear):
        return 1.0
    tip = np.array([kinematics.jacobian(start + s * path) @ path for s in np.linspace(0.0, 1.0, PLACES)])
    linear, angular = np.linalg.norm(tip[:, :3], axis=1).max(), np.linalg.norm(tip[:, 3:], axis=1).max()
    least_time = max(linear / cap.linear, angular / cap.angular)
    moved = np.abs(path) > STILL
    fastest = float((velocity[moved] / np.abs(path[moved])).min())
    return min(1.0, PLANNED / (float(least_time) * fastest)) if least_time > 0.0 else 1.0


def parse_regime(text: str, present: Regime, moving: bool) -> Regime:
    """Return the regime that a text on `command/regime` names.

    Args:
        text: name of the regime.
        present: regime in force.
        moving: a motion mode owns the robot.

    Raises:
        SettingsError: the name is unknown, the change is from or to the bench, or to `free` while the robot is in use.
    """
    name = text.strip()
    choices = [Regime.NEAR_TISSUE, Regime.FREE]
    if name not in [regime.value for regime in choices] or present is Regime.BENCH:
        known = ", ".join(regime.value for regime in choices)
        remedy = "send one of these; bench is chosen at the start, and left by a start without it"
        raise SettingsError(f"regime cannot change from {present.value}", value=name, limit=known, remedy=remedy)
    if name == Regime.FREE.value and moving:
        raise SettingsError("the regime cannot become free while the robot is in use", remedy="release the pedal")
    return Regime(name)
