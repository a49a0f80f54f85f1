"""How far the tip travels with an axis that goes by itself, at any speed, and with a force that is none.

These travels are stated, not held against a budget: no setting of a time limit bounds them. An axis is found by its
distance, so there is no speed at which it creeps unseen. A false force is found by its size.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_common.vectors import Vector
from sher3_control.motion.speed_cap import SpeedCap
from sher3_control.settings import ControlSettings
from sher3_control.supervision.hand import HandDetector
from sher3_description import ACTUATORS
from sher3_drivers.settings import MotorDriverSettings
from sher3_kinematics import RobotKinematics

from sher3_faults.braking import Braking

Array = NDArray[np.float64]
SPEEDS = (1e-6, 1e-5, 1e-4, 1e-3)
"""Speeds of a creeping axis [m/s, rad/s]; its drive's own limit comes last."""
ECHOES = ("honest", "false", "missing")
"""What the drive says of the velocity that it executes: the truth, the command, or nothing."""
HANDS = (0.2, 0.3, 0.4, 0.6, 1.0, 2.0, 6.0)
"""Forces that are false [N]: of a hand that has left a sensor that stays where it was."""
LATEST = 2.0
"""Time [s] after which a false force counts as believed."""


class Creep(NamedTuple):
    """An axis that goes by itself: its speed [m/s, rad/s], its drive's echo, the tip's travel until it rests [m]."""

    axis: str
    speed: float
    echo: str
    travel: float


class FalseForce(NamedTuple):
    """A false force [N]: when it is noticed [s], and the tip's travel until it rests [m]; infinite: never."""

    force: float
    detection: float
    travel: float


def creeps(braking: Braking, drives: MotorDriverSettings, caps: Vector, cap: SpeedCap) -> list[Creep]:
    """Return the travel of each axis at every speed up to its drive's own limit, `caps` (5,), for each echo.

    It is noticed when it has left its commands by the limit at the speeds that the regime allows, and two periods
    later; then it brakes on its ramp. An honest echo tells before that, of all that is not forgotten meanwhile.
    """
    v = np.minimum(np.array([*SPEEDS, np.inf])[:, None], np.array(caps))
    left = per_axis(drives.position_distance, drives.position_angle)
    left = left + drives.position_lag * np.minimum(braking.axis_speeds(cap.linear, cap.angular), np.array(caps))
    noticed = _until_noticed(v, drives)
    after = 2.0 * v * drives.period + v * v / (2.0 * braking.deceleration) + v * braking.lag
    ways = {"honest": np.minimum(left, noticed) + after, "false": left + after, "missing": left + after}
    return [
        Creep(name, float(v[row, axis]), echo, float(braking.reach()[axis] * ways[echo][row, axis]))
        for axis, name in enumerate(ACTUATORS)
        for echo in ECHOES
        for row in range(len(v))
    ]


def cut_off(braking: Braking, drives: MotorDriverSettings, caps: Vector) -> dict[str, float]:
    """Return the tip's travel [m] with an axis that goes by itself at its drive's own limit, `caps` (5,), unheard.

    Its drive neither hears nor is heard, so it brakes when it misses the host's heartbeat, two periods later at most.
    """
    v = np.array(caps)
    way = v * (drives.host_heartbeat_limit + 2.0 * drives.period + braking.lag) + v * v / (2.0 * braking.deceleration)
    return dict(zip(ACTUATORS, (braking.reach() * way).tolist(), strict=True))


def given_way(braking: Braking, ki: Array, share: float) -> Array:
    """Return what a newton at the tip adds to the tip's travel per axis (5,) [m/N].

    It pushes an axis off by its force over `ki`, and the drive's force explains that to all but a `share`.
    """
    reach = np.linalg.norm(braking.jacobians[:, :3], axis=1)
    return np.asarray(share * (reach * reach / ki).max(axis=0))


def _until_noticed(v: Array, drives: MotorDriverSettings) -> Array:
    """Return how far axes go at speeds `v` (n, 5) until their honest echoes give them away; inf: they never do."""
    limit, memory = per_axis(drives.obey_distance, drives.obey_angle), drives.following_memory
    with np.errstate(divide="ignore", invalid="ignore"):
        time = -memory * np.log1p(-limit / (v * memory))
    return np.where(v * memory > limit, v * time, np.inf)


def false_forces(control: ControlSettings, kinematics: RobotKinematics, cap: SpeedCap, stop: float, period: float) -> (
    list[FalseForce]
):  # fmt: skip
    """Return what comes of a hand that has left a sensor that stays where it was, pedal fully pressed.

    `stop`: time at full speed that covers the braking distance [s].
    """
    law, supervisor = control.admittance, control.supervisor
    lags = float(np.mean([leg.mass / leg.drive.kp for leg in kinematics.robot.actuators[:3]]))
    late = supervisor.heartbeat_period + 2.0 * period + lags
    found = []
    for force in HANDS:
        speed = min(cap.linear, law.linear_gain * max(0.0, force - law.force_deadband))
        detection = _noticed(HandDetector(kinematics, control), force, speed, period, supervisor.hand_gap) + late
        found.append(FalseForce(force, detection, speed * (detection + stop) if speed else 0.0))
    return found


def _noticed(detector: HandDetector, force: float, speed: float, period: float, gap: float) -> float:
    """Return when the detector objects to a hand that has left [s], without noise.

    Before that nothing changes, so the longest ticks it knows of, `gap` [s], tell as much as its own.
    """
    tick, felt, moved = round(period * 1e9), force * np.eye(5)[2], speed * period * np.eye(6)[2]
    settling = range(0, 2 * 10**9, round(gap * 1e9))
    for stamp in settling:
        detector.follow(stamp, felt, -felt)
    begin = settling[-1] + tick
    for stamp in range(begin, begin + round(LATEST * 1e9), tick):
        detector.follow(stamp, felt, 0.0 * felt, moved)
        if detector.check(stamp) is not None:
            return (stamp - begin) * 1e-9
    return float("inf")


def per_axis(distance: float, angle: float) -> Array:
    """Return a limit of sliders [m] and roll [rad] in the order of ACTUATORS."""
    return np.array([distance] * 3 + [angle, distance])
