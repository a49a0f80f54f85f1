"""Recorded runs as inputs of the plant: what drove the robot drives the model."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_bags.run import Run
from sher3_common.compiled import compiled
from sher3_common.numbers.smoothing import savitzky_golay
from sher3_description import Robot
from sher3_description.contract import GRAVITY, REFERENCE_TEMPERATURE
from sher3_kinematics.kernel import (
    KernelParameters,
    gravity_load_into,
    kernel_parameters,
    tip_jacobian_into,
    tip_pose_into,
)

from sher3_sim.closed_loop import Array, Excitation, excitation, simulate
from sher3_sim.effect import PlantEffect
from sher3_sim.kernel.tip import cross

SMOOTHING = 11
"""Ticks over which a parabola is fitted to the recorded wrench before it acts on the model: the fit removes noise and
keeps edges."""


def contact_wrench(run: Run, robot: Robot, smoothing: int = SMOOTHING) -> Array:
    """Return the contact wrench (n, 6) at the tip in {b} that the recorded force sensor and load encoders imply.

    It has a row for each sample of `measured_js`; where the sensor's was lost, the one before it stays.

    The weight of the tool is subtracted and the moment is moved from {f} to the tip (contract, section 3), all by the
    nominal model.

    Raises:
        MissingTopicError: `measured_js` or `force/measured_cf` was not recorded.
    """
    sensed = run["force/measured_cf"]
    joints, sensor = run["measured_js"], robot.force_sensor
    readings, q = held(np.column_stack([sensed.force, sensed.torque]), sensed.stamp, joints.stamp), joints.position
    place, com = np.array(sensor.position), np.array(sensor.tool_com)
    raw = _to_tip(kernel_parameters(robot), q, readings, sensor.tool_mass * GRAVITY, com, place)
    return savitzky_golay(raw, min(smoothing, (len(raw) - 1) // 2 * 2 + 1), min(2, len(raw) - 1))


def held(values: Array, stamp: NDArray[np.int64], at: NDArray[np.int64]) -> Array:
    """Return (m, ...) the newest row of values (n, ...) with stamps (n,) at each of the stamps (m,); else the first."""
    return values[np.maximum(np.searchsorted(stamp, at, side="right") - 1, 0)]


@compiled
def _to_tip(p: KernelParameters, q: Any, reading: Any, weight: float, com: Any, place: Any) -> Any:
    out, rotation, position = np.empty((len(q), 6)), np.empty((3, 3)), np.empty(3)
    for k in range(len(q)):
        tip_pose_into(p, np.ascontiguousarray(q[k]), rotation, position)
        gravity = -weight * rotation[2]
        force = reading[k, :3] - gravity
        moment = reading[k, 3:] - cross(com, gravity) + cross(place, force)
        for i in range(3):
            out[k, i], out[k, 3 + i] = 0.0, 0.0
            for j in range(3):
                out[k, i] += rotation[i, j] * force[j]
                out[k, 3 + i] += rotation[i, j] * moment[j]
    return out


@compiled
def _axis_loads(p: KernelParameters, q: Any, wrench: Any) -> Any:
    out, jacobian = np.empty((len(q), 5)), np.empty((6, 5))
    for k in range(len(q)):
        position = np.ascontiguousarray(q[k])
        gravity_load_into(p, position, out[k])
        tip_jacobian_into(p, position, jacobian)
        for i in range(5):
            for j in range(6):
                out[k, i] -= jacobian[j, i] * wrench[k, j]
    return out


def axis_loads(robot: Robot, q: Array, wrench: Array) -> Array:
    """Return (n, 5) the load G(q) - J^T W on the nominal axes [N, N m] at positions (n, 5) under wrenches (n, 6)."""
    return _axis_loads(kernel_parameters(robot), np.ascontiguousarray(q), np.ascontiguousarray(wrench))


def recorded_temperature(run: Run, stamp: NDArray[np.int64]) -> Array:
    """Return (n,) the recorded structure temperature [degC] at the stamps, the reference where none was recorded."""
    if "temperature" not in run:
        return np.full(len(stamp), REFERENCE_TEMPERATURE)
    seen = run["temperature"]
    return np.interp(stamp, seen.stamp, seen.temperature)


def recorded_excitation(run: Run, robot: Robot, *, open_loop: bool = False) -> Excitation:
    """Return what drove a recorded run: its set-points, wrench and temperature.

    With `open_loop` its recorded commands (`servo_jv`) take the place of the set-points, a row for each tick from the
    first to the last: where samples were lost, those before them stay.

    Raises:
        MissingTopicError: The run lacks a stream that this needs.
    """
    wrench = contact_wrench(run, robot)
    if open_loop:
        commands = run["servo_jv"]
        ticks = np.arange(commands.stamp[0], commands.stamp[-1] + 1, round(robot.control_period * 1e9))
        velocity = held(commands.velocity, commands.stamp, ticks)
        start = np.broadcast_to(run["measured_js"].position[0], velocity.shape)
        wrench = held(wrench, run["measured_js"].stamp, ticks)
        return excitation(start, None, wrench, recorded_temperature(run, ticks), velocity, period=robot.control_period)
    goal = run["setpoint_js"]
    wrench = held(wrench, run["measured_js"].stamp, goal.stamp)
    warmth = recorded_temperature(run, goal.stamp)
    return excitation(goal.position, goal.velocity, wrench, warmth, period=robot.control_period)


def resimulate(
    run: Run, robot: Robot, effects: Iterable[PlantEffect] = (), seed: int = 0, *, open_loop: bool = False
) -> Run:
    """Return the run that the model makes of what drove a recorded run.

    Raises:
        MissingTopicError, InputError, EffectError: See `recorded_excitation` and `simulate`.
    """
    drive = recorded_excitation(run, robot, open_loop=open_loop)
    return simulate(
        robot,
        drive.position,
        drive.wrench,
        effects,
        seed,
        setpoint_velocity=drive.velocity,
        command=drive.command,
        temperature=drive.temperature,
        start_stamp=run.start,
        metadata=run.metadata,
    )
