"""Whole runs of the plant under the host's law, in one compiled call."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sher3_bags.run import Run, RunMetadata, stream
from sher3_common.compiled import compiled
from sher3_description import Robot
from sher3_description.contract import REFERENCE_TEMPERATURE
from sher3_kinematics.kernel import KernelParameters, kernel_parameters, tip_pose_into

from sher3_sim.effect import PlantEffect, with_effects
from sher3_sim.errors import InputError
from sher3_sim.kernel import robot as kernel
from sher3_sim.kernel.axis import AXIS_STATE, propagators
from sher3_sim.kernel.tip import quaternion
from sher3_sim.parameters import PlantParameters
from sher3_sim.plant import checked
from sher3_sim.scatter import RunScatter

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Excitation:
    """What drives a run, for n ticks one control period apart.

    Attributes:
        position: q_ref (n, 5) [m, rad]; with a `command` only the first row counts, as the start.
        velocity: Rate of q_ref (n, 5) [m/s, rad/s].
        wrench: Contact wrench at the tip in {b} (n, 6) [N, N m].
        temperature: Temperature of the structure (n,) [degC].
        command: Recorded `servo_jv` (n, 5) to execute as it is; None closes the loop by the host's law.
    """

    position: Array
    velocity: Array
    wrench: Array
    temperature: Array
    command: Array | None = None


def excitation(
    position: ArrayLike,
    velocity: ArrayLike | None = None,
    wrench: ArrayLike | None = None,
    temperature: ArrayLike = REFERENCE_TEMPERATURE,
    command: ArrayLike | None = None,
    *,
    period: float,
) -> Excitation:
    """Return a checked excitation; without a velocity it is the central difference of the positions.

    Raises:
        InputError: wrong shape or not finite.
    """
    n = len(np.atleast_2d(np.asarray(position)))
    if n < 2:
        raise InputError("a run needs at least two ticks", value=n, limit=2)
    q = checked("position", position, (n, 5))
    rate = np.gradient(q, period, axis=0) if velocity is None else checked("velocity", velocity, (n, 5))
    contact = np.zeros((n, 6)) if wrench is None else checked("wrench", wrench, (n, 6))
    # A copy: an array that can be written, as all others; a view of one number would have the plant compiled twice.
    warmth = checked("temperature", np.broadcast_to(np.asarray(temperature, dtype=float), (n,)).copy(), (n,))
    open_loop = None if command is None else checked("command", command, (n, 5))
    return Excitation(q, rate, contact, warmth, open_loop)


def simulate_arrays(parameters: PlantParameters, drive: Excitation, seed: int = 0) -> tuple[Array, NDArray[Any]]:
    """Run the plant and return `servo_jv` (n, 5) and the READING records (n,): the fast entry, for fits.

    The parameters are not changed.
    """
    n = len(drive.position)
    axes, body, out = np.zeros(5, AXIS_STATE), np.zeros(1, kernel.BODY_STATE), np.zeros(n, kernel.READING)
    body["seed"] = seed
    closed = drive.command is None
    command = np.zeros((n, 5)) if drive.command is None else drive.command.copy()
    axis, record = parameters.axis, parameters.body.copy()[0]
    maps = propagators(axis, float(record["period"]) / parameters.substeps)
    plant = (axis, record, parameters.geometry, maps, parameters.substeps, axes, body[0])
    kernel.run(*plant, closed, drive.position, drive.velocity, command, drive.wrench, drive.temperature, out)
    return command, out


def simulate(
    robot: Robot,
    setpoints: ArrayLike,
    contact_wrench: ArrayLike | None = None,
    effects: Iterable[PlantEffect] = (),
    seed: int = 0,
    *,
    setpoint_velocity: ArrayLike | None = None,
    command: ArrayLike | None = None,
    temperature: ArrayLike = REFERENCE_TEMPERATURE,
    start_stamp: int = 0,
    metadata: RunMetadata | None = None,
    parameters: PlantParameters | None = None,
    scatter: RunScatter | None = None,
) -> Run:
    """Simulate one run of the contract in one compiled call.

    Args:
        robot: The nominal robot.
        setpoints: q_ref at the ticks (n, 5); with `command` only the first row counts.
        contact_wrench: Wrench at the tip in {b} (n, 6) [N, N m]; by default none.
        effects: What the plant does that the nominal model does not.
        seed: Seed of all noise.
        setpoint_velocity: Rate of the set-points (n, 5); by default their central difference.
        command: Recorded `servo_jv` (n, 5) to execute instead of closing the loop.
        temperature: Temperature of the structure [degC], scalar or (n,).
        start_stamp: First header stamp [ns].
        metadata: Metadata of the run; by default those of an unnamed plant run with this seed.
        parameters: Parameters of the plant; they replace `effects` for a caller that has them at hand.
        scatter: Run-to-run variation, drawn from the seed; by default none.

    Raises:
        InputError, EffectError: See `excitation` and `with_effects`.
    """
    drive = excitation(setpoints, setpoint_velocity, contact_wrench, temperature, command, period=robot.control_period)
    plant = with_effects(robot, effects) if parameters is None else parameters
    if scatter is not None:
        plant = scatter.apply(plant, seed)
    commanded, readings = simulate_arrays(plant, drive, seed)
    run = _as_run(robot, drive, commanded, readings, start_stamp)
    run.metadata = metadata if metadata is not None else RunMetadata(origin="plant", seed=seed)
    run.robot_yaml = _text_of(robot)
    return run


@lru_cache(maxsize=8)
def _text_of(robot: Robot) -> str:
    """Return the text of the robot file, remembered: writing it costs as much as a run."""
    return robot.to_yaml()


def _as_run(robot: Robot, drive: Excitation, command: Array, r: NDArray[Any], start_stamp: int) -> Run:
    n = len(r)
    stamp = start_stamp + np.arange(n, dtype=np.int64) * round(robot.control_period * 1e9)
    position, orientation = poses(kernel_parameters(robot), r["load"])
    second = np.arange(0, n, max(1, round(1.0 / robot.control_period)))
    seen = r["tracked"]
    released = {"axes": np.ones((n, 1)), "buttons": np.zeros((n, 1), np.int32)}
    streams: dict[str, dict[str, Any]] = {
        "servo_jv": {"velocity": command},
        "drives/setpoint_jv": {"velocity": r["demand"]},
        "drives/measured_js": {"position": r["motor"], "velocity": r["velocity"], "effort": r["effort"]},
        "measured_js": {"position": r["load"]},
        "measured_cp": {"position": position, "orientation": orientation},
        "force/measured_cf": {"force": r["wrench"][:, :3], "torque": r["wrench"][:, 3:]},
        "pedal/measured": released,
    }
    if drive.command is None:
        streams["setpoint_js"] = {"position": drive.position, "velocity": drive.velocity}
    built = {topic: stream(topic, stamp, **columns) for topic, columns in streams.items()}
    built["temperature"] = stream("temperature", stamp[second], temperature=drive.temperature[second])
    built["tracker/measured_cp"] = stream(
        "tracker/measured_cp",
        stamp[seen],
        position=r["tracker_position"][seen],
        orientation=r["tracker_orientation"][seen],
    )
    return Run(built)


@compiled
def poses(p: KernelParameters, q: Any) -> tuple[Any, Any]:
    """Return tip positions (n, 3) [m] and quaternions (n, 4) (x, y, z, w) in {b} for actuator positions (n, 5)."""
    n = len(q)
    position, orientation, rotation = np.empty((n, 3)), np.empty((n, 4)), np.empty((3, 3))
    for k in range(n):
        tip_pose_into(p, np.ascontiguousarray(q[k]), rotation, position[k])
        quaternion(rotation, orientation[k])
    return position, orientation
