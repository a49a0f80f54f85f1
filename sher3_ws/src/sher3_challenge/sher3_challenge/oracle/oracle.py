"""The oracle: what each stage's gap is when one knows the truth, and how much of it the true causes close.

Residuals come from the recorded topics and the nominal equations, stage by stage. The floor F is half the mean square
difference of the residuals of repeats. A fault's own part is the mean square difference between the residuals of two
ideal runs (no sensor noise, no rounding) that differ by the fault alone, so errors of the predictors cancel:
L0 = F + |faulty - nominal|^2, L1 = F + |as built - nominal|^2; the true causes close (L0 - L1) / (L0 - F).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt
from sher3_bags import Run
from sher3_description import ACTUATORS, Robot

from sher3_challenge.oracle import nominal

Array = NDArray[np.floating[Any]]
Mask = NDArray[np.bool_]
Residuals = dict[str, Array]

BANDWIDTH = 40.0
"""Low-pass of force residuals [Hz]."""
LOAD_MARGIN = 0.03
"""Time left out at both ends of a load plateau [s]."""
SURROUND = 0.15
"""Time around a load plateau in which the force on the tip is not known [s]."""
SIGNIFICANT = 0.3
"""Share of the floor above which a fault's own part is said to be closed by its causes."""
EXACT = ("transport", "controller")
"""Stages whose floor is rounding."""


@dataclass(frozen=True)
class StageOracle:
    """Mean squares of one stage: nominal gap and floor; closure by the true causes; gap/floor, None where exact."""

    L0: float
    F: float
    closure: float | None
    gap_over_floor: float | None

    def as_dict(self) -> dict[str, float | None]:
        """Return the plain mapping of the truth file."""
        return asdict(self)


def _low_pass(x: Array, period: float) -> Array:
    return np.asarray(sosfiltfilt(butter(2, 2 * BANDWIDTH * period, output="sos"), x, axis=0))


def contact_of(run: Run, time: Array) -> tuple[Array, Mask, Mask]:
    """Return the known force (n, 3), where it is known (n,), and where a load is on (n,)."""
    force, known, loaded = np.zeros((len(time), 3)), np.ones(len(time), bool), np.zeros(len(time), bool)
    for start, end, *load in run.metadata.payload:
        on = (time >= start + LOAD_MARGIN) & (time <= end - LOAD_MARGIN)
        near = (time >= start - SURROUND) & (time <= end + SURROUND) & ~on
        force[on], loaded[on], known[near] = load, True, False
    return force, known, loaded


def stage_residuals(run: Run, robot: Robot) -> Residuals:
    """Return residuals (n, d) by `stage/actuator`, over the samples that count.

    `tip/tip` is the tracked tip against the load encoders; `tip_free/tip` is the tracked tip itself, which only makes
    sense as a difference from another run of the same set-points.
    """
    command, echo = run["servo_jv"].velocity, run["drives/setpoint_jv"].velocity
    setpoint, drives = run["setpoint_js"], run["drives/measured_js"]
    load = run["measured_js"].position
    time = run["measured_js"].seconds()
    force, known, loaded = contact_of(run, time)
    limit = np.array([actuator.limits.velocity for actuator in robot.actuators])
    law = setpoint.velocity + robot.position_gain * (setpoint.position - load)
    by_axis = {
        "transport": echo[1:] - command[:-1],
        "controller": command - np.clip(law, -limit, limit),
        "drive": _drive_residual(robot, echo, drives.position, drives.effort),
        "motor_mechanics": _motor_residual(robot, echo, drives.position, drives.effort, load, force)[known[1:-2]],
        "transmission": load - drives.position,
    }
    residuals = {f"{stage}/{name}": r[:, j : j + 1] for stage, r in by_axis.items() for j, name in enumerate(ACTUATORS)}
    _, rotation = nominal.tip_pose(robot, load)
    reading = run["force/measured_cf"].force - nominal.force_reading(robot, rotation, force)[:, :3]
    residuals["sensing/force_sensor"] = reading[known]
    if "tracker/measured_cp" in run:
        residuals |= _tip_residuals(run, robot, time, known, loaded)
    return residuals


def _drive_residual(robot: Robot, echo: Array, motor: Array, effort: Array) -> Array:
    """PI law on demand and motion against reported effort, each run's constant left out (the integrator's start)."""
    period = robot.control_period
    kp = np.array([a.drive.kp for a in robot.actuators])
    ki = np.array([a.drive.ki for a in robot.actuators])
    velocity = np.gradient(motor, period, axis=0)
    law = kp * (echo - velocity) + ki * (np.cumsum(echo, axis=0) * period - motor)
    residual = effort - law
    return np.asarray(_low_pass(residual - residual.mean(axis=0), period))


def _motor_residual(robot: Robot, echo: Array, motor: Array, effort: Array, load: Array, contact: Array) -> Array:
    """Force the rigid axis does not explain, (n - 3, axes), centred on ticks 1 to n - 3."""
    period = robot.control_period
    mass = np.array([a.mass for a in robot.actuators])
    viscous = np.array([a.viscous for a in robot.actuators])
    kp = np.array([a.drive.kp for a in robot.actuators])
    # force over an interval: it steps with the demand at its start and moves on to the next reading
    step = kp * np.diff(echo, axis=0)
    mean = 0.5 * (effort[:-1] + step + effort[1:])
    force = 0.5 * (mean[:-1] + mean[1:])
    speed = np.diff(motor, axis=0) / period
    acceleration = np.diff(speed, axis=0) / period
    middle = 0.5 * (speed[:-1] + speed[1:])
    static, on = nominal.gravity(robot, load), contact.any(axis=1)
    static[on] -= np.einsum("nij,ni->nj", nominal.tip_jacobian(robot, load[on]), contact[on])
    residual = force - mass * acceleration - viscous * middle - static[1:-1]
    return np.asarray(_low_pass(residual, period)[:-1])


def _tip_residuals(run: Run, robot: Robot, time: Array, known: Mask, loaded: Mask) -> Residuals:
    tracker = run["tracker/measured_cp"]
    tick = np.searchsorted(run["measured_js"].stamp, tracker.stamp)
    tip, _ = nominal.tip_pose(robot, run["measured_js"].position[tick])
    error = tracker.position - tip
    free, on = known[tick] & ~loaded[tick], loaded[tick]
    residuals = {"mechanism/tip": error[free], "tip/tip": error, "tip_free/tip": tracker.position}
    if on.any():
        residuals["structure/tip"] = error[on] - error[free].mean(axis=0)
    return residuals


def floors(runs: Sequence[Run], residuals: Sequence[Residuals], robot: Robot) -> dict[str, float]:
    """Return the floor F of every stage: half the mean square difference between repeats, over all pairs.

    Repeats of a standstill round alike, so the transmission's floor is at least the variance of its rounding.
    """
    groups: dict[str, list[Residuals]] = {}
    for run, r in zip(runs, residuals, strict=True):
        groups.setdefault(run.metadata.excitation, []).append(r)
    total: dict[str, list[float]] = {}
    for members in groups.values():
        for a, b in combinations(members, 2):
            for key in sorted(a.keys() & b.keys()):
                n = min(len(a[key]), len(b[key]))
                total.setdefault(key, []).append(0.5 * _power(a[key][:n] - b[key][:n]))
    floor = {key: float(np.mean(values)) for key, values in total.items()}
    for name, actuator in zip(ACTUATORS, robot.actuators, strict=True):
        key = f"transmission/{name}"
        rounding = (actuator.motor_encoder**2 + actuator.load_encoder**2) / 12
        floor[key] = max(floor.get(key, 0.0), rounding)
    return floor


def excess(runs: Sequence[Residuals], reference: Sequence[Residuals]) -> dict[str, float]:
    """Return by stage the mean square difference of ideal residuals from those of the reference."""
    total: dict[str, list[float]] = {}
    for a, b in zip(runs, reference, strict=True):
        for key in sorted(a.keys() & b.keys()):
            total.setdefault(key, []).append(_power(a[key] - b[key]))
    return {key: float(np.mean(values)) for key, values in total.items()}


def _power(x: Array) -> float:
    return float(np.mean(np.sum(np.square(x), axis=1)))


def oracle(
    floor: Mapping[str, float], faulty: Mapping[str, float], built: Mapping[str, float]
) -> dict[str, StageOracle]:
    """Combine floor and the excesses of the faulty and of the as-built robot over the nominal one."""
    result = {}
    for key, gap in faulty.items():
        f = floor.get(key, 0.0)
        exact = key.split("/")[0] in EXACT
        significant = gap > (0.0 if exact else SIGNIFICANT * f)
        closure = (gap - built[key]) / gap if significant and gap > 0 else None
        ratio = None if exact or f <= 0 else float(np.sqrt((f + gap) / f))
        result[key] = StageOracle(f + gap, f, closure, ratio)
    return result
