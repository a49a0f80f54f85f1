"""The recorder of every truth plant: true signals into a run in the form of the contract, with its noise and rounding.

What stands here is the contract's (section 3, sensors, and section 4), not any plant's: noise and resolution of effort,
force sensor, tracker and thermometer. Errors of a sensor are the plant's and are in the signals already.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from sher3_bags import Run, Stream, stream
from sher3_description import Robot
from sher3_description.contract import EFFORT_NOISE, EFFORT_RESOLUTION

from sher3_challenge.oracle import nominal
from sher3_challenge.plants.plant import Array, RunPlan

THERMOMETER_NOISE = 0.02  # K, standard deviation


class Signals(NamedTuple):
    """What a plant hands to the recorder, per tick: actuator units, N, N m, m, degC."""

    command: Array  # (n, 5) velocity command of the host
    echo: Array  # (n, 5) demand the drive executed in the interval that ended here
    motor: Array  # (n, 5) reading of the motor encoder, rounded already
    load: Array  # (n, 5) reading of the load encoder, rounded already
    effort: Array  # (n, 5) force the drive reports, without noise
    wrench: Array  # (n, 6) what the force sensor would read in {f} without noise and rounding
    tip: Array  # (n, 3) what the tracker would see of the tip
    turn: Array  # (n, 3, 3) rotation of {t} that it would see
    temperature: Array  # (n,) of the structure


def recorded(
    robot: Robot, plan: RunPlan, signals: Signals, rng: np.random.Generator, *, tracker: bool, ideal: bool
) -> Run:
    """Return the recorded run of a plan.

    Args:
        robot: the robot file in force.
        plan: what was asked for.
        signals: what the plant did.
        rng: source of the noise; its state moves on.
        tracker: whether the tip is tracked.
        ideal: sensors without noise and rounding.
    """
    noise = 0.0 if ideal else 1.0
    period, n = robot.control_period, len(signals.command)
    stamps = plan.stamp + np.arange(n) * round(period * 1e9)
    wrench = signals.wrench if ideal else _force_reading(robot, signals.wrench, rng)
    streams = _joint_streams(robot, plan, signals, signals.effort if ideal else _effort(robot, signals, rng), stamps)
    streams["force/measured_cf"] = stream("force/measured_cf", stamps, force=wrench[:, :3], torque=wrench[:, 3:])
    streams["pedal/measured"] = stream("pedal/measured", stamps, axes=np.zeros((n, 1)), buttons=np.zeros((n, 1)))
    every = round(1.0 / period)
    warmth = signals.temperature[::every]
    read = warmth + THERMOMETER_NOISE * noise * rng.standard_normal(len(warmth))
    streams["temperature"] = stream("temperature", stamps[::every], temperature=read)
    if tracker:
        watch = slice(None, None, round(1 / (robot.tracker.rate * period)))
        position, orientation = _tracked(robot, signals.tip[watch], signals.turn[watch], rng, noise)
        streams["tracker/measured_cp"] = stream(
            "tracker/measured_cp", stamps[watch], position=position, orientation=orientation
        )
    return Run(streams, plan.excitation.metadata(plan.repeat, seed=plan.seed), _robot_text(robot))


@lru_cache(maxsize=8)
def _robot_text(robot: Robot) -> str:
    return robot.to_yaml()


def _force_reading(robot: Robot, wrench: Array, rng: np.random.Generator) -> Array:
    sensor = robot.force_sensor
    spread = np.repeat([sensor.noise_force, sensor.noise_torque], 3)
    resolution = np.repeat([sensor.resolution_force, sensor.resolution_torque], 3)
    noisy = wrench + spread * rng.standard_normal(wrench.shape)
    return np.asarray(np.round(noisy / resolution) * resolution)


def _effort(robot: Robot, signals: Signals, rng: np.random.Generator) -> Array:
    rated = np.array([actuator.drive.rated for actuator in robot.actuators])
    noisy = signals.effort + EFFORT_NOISE * rated * rng.standard_normal(signals.effort.shape)
    step = EFFORT_RESOLUTION * rated
    return np.asarray(np.round(noisy / step) * step)


def _tracked(robot: Robot, tip: Array, turn: Array, rng: np.random.Generator, noise: float) -> tuple[Array, Array]:
    """Return tracker positions (m, 3) and quaternions (m, 4, x y z w)."""
    spread = robot.tracker
    position = tip + noise * spread.noise_position * rng.standard_normal(tip.shape)
    wobble = Rotation.from_rotvec(noise * spread.noise_rotation * rng.standard_normal((len(tip), 3)))
    return position, (wobble * Rotation.from_matrix(turn)).as_quat()


def _joint_streams(
    robot: Robot, plan: RunPlan, signals: Signals, effort: Array, stamps: NDArray[np.integer]
) -> dict[str, Stream]:
    e = plan.excitation
    velocity = np.zeros_like(signals.motor)
    velocity[1:] = np.diff(signals.motor, axis=0) / robot.control_period
    tip, rotation = nominal.tip_pose(robot, signals.load)
    return {
        "setpoint_js": stream("setpoint_js", stamps, position=e.position, velocity=e.velocity),
        "servo_jv": stream("servo_jv", stamps, velocity=signals.command),
        "drives/setpoint_jv": stream("drives/setpoint_jv", stamps, velocity=signals.echo),
        "drives/measured_js": stream(
            "drives/measured_js", stamps, position=signals.motor, velocity=velocity, effort=effort
        ),
        "measured_js": stream("measured_js", stamps, position=signals.load),
        "measured_cp": stream("measured_cp", stamps, position=tip, orientation=rotation.as_quat()),
    }
