"""How well each axis follows what it is asked to do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_description import Robot

from sher3_bags.figures.gaps import PAUSE_NS
from sher3_bags.figures.statistics import common, smooth, width_of
from sher3_bags.run import Run

SMOOTHING = 0.02
"""Time [s] over which velocities are averaged: over a single period the steps of the encoder would dominate."""


class Error(NamedTuple):
    """Wanted minus measured: stamps (n,) int64 [ns] and values (n, 5) [m, rad] or [m/s, rad/s]."""

    stamp: NDArray[np.int64]
    values: NDArray[np.float64]


@dataclass(frozen=True)
class AxisError:
    """Tracking error of one actuator [m, rad] or [m/s, rad/s]."""

    actuator: str
    unit: str
    mean: float
    rms: float
    max: float


def position_error(run: Run) -> Error | None:
    """Return setpoint_js minus measured_js (load encoder); None outside of position modes."""
    return _difference(run, "setpoint_js", "measured_js", "position")


def velocity_error(run: Run) -> Error | None:
    """Return drives/setpoint_jv minus the motor velocity, averaged over 20 ms."""
    error = _difference(run, "drives/setpoint_jv", "drives/measured_js", "velocity")
    if error is None:
        return None
    return Error(error.stamp, smooth(error.values, width_of(error.stamp, SMOOTHING)))


def drive_error(run: Run) -> Error | None:
    """Return the integral of drives/setpoint_jv minus the travel of the motor, in any mode.

    A demand holds for the interval that ends at its stamp (contract, section 4). During a pause of the topic the motor
    is taken to be at rest.
    """
    if not {"drives/setpoint_jv", "drives/measured_js"} <= set(run.streams):
        return None
    demand, motor = run["drives/setpoint_jv"], run["drives/measured_js"]
    a, b = common(demand.stamp, motor.stamp)
    if demand.velocity is None or motor.position is None or not len(a):
        return None
    interval = np.diff(demand.stamp[a], prepend=demand.stamp[a[0]])
    seconds = np.where(interval > PAUSE_NS, 0, interval) * 1e-9
    wanted = np.cumsum(demand.velocity[a] * seconds[:, None], axis=0)
    return Error(demand.stamp[a], wanted - (motor.position[b] - motor.position[b[0]]))


def _difference(run: Run, wanted: str, measured: str, column: str) -> Error | None:
    if wanted not in run or measured not in run:
        return None
    one, two = getattr(run[wanted], column), getattr(run[measured], column)
    a, b = common(run[wanted].stamp, run[measured].stamp)
    if one is None or two is None or not len(a):
        return None
    return Error(run[wanted].stamp[a], one[a] - two[b])


def axis_errors(run: Run, robot: Robot, error_of: Callable[[Run], Error | None]) -> tuple[AxisError, ...]:
    """Return the statistics per axis of one of the errors above; empty when the run lacks its topics."""
    error = error_of(run)
    finite = None if error is None else error.values[np.isfinite(error.values).all(axis=1)]
    if finite is None or not len(finite):
        return ()
    per = "/s" if error_of is velocity_error else ""
    return tuple(
        AxisError(
            actuator.name,
            ("rad" if actuator.kind == "revolute" else "m") + per,
            float(values.mean()),
            float(np.sqrt(np.mean(values**2))),
            float(np.abs(values).max()),
        )
        for actuator, values in zip(robot.actuators, finite.T, strict=True)
    )
