"""What the force sensor makes of the truth, noise and rounding left to the recorder."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_description import Robot
from sher3_description.contract import GRAVITY

from sher3_challenge.plants.mujoco.axes.parts import Array, Bristle
from sher3_challenge.plants.mujoco.rig import Sensor


def force_reading(
    robot: Robot, s: Sensor, turn: Rotation, roll: Array, angle: Array, contact: Array, kelvin: Array
) -> Array:
    """Return (n, 6) readings in {f}.

    Args:
        robot: nominal robot, for the sensor's place.
        s: the sensor as it is.
        turn: n rotations of {t} in {b}.
        roll: (n,) roll [rad], which winds the cable.
        angle: (n,) tilt [rad].
        contact: (n, 3) force at the tip in {b}.
        kelvin: (n,) temperature above 22 degC.
    """
    force = turn.apply(contact, inverse=True)
    weight = turn.apply([0.0, 0.0, -s.tool_mass * GRAVITY], inverse=True)
    torque = np.cross(-np.asarray(robot.force_sensor.position), force) + np.cross(s.tool_com, weight)
    wrench = np.hstack([force + weight, torque])
    wrench[:, 0] += s.cable[1] * angle
    wrench[:, 1] += s.cable[0] * roll
    for bristle in s.cable_bristles:
        wrench[:, 1] += dragged(bristle, roll)
    wrench = wrench @ s.matrix.T + s.bias + np.outer(kelvin, s.drift)
    return late(wrench, s.late, robot.control_period)


def dragged(bristle: Bristle, x: Array) -> Array:
    """Return (n,) the force of a bristle whose foot slips: between -force and force."""
    foot, out = x[0], np.empty_like(x)
    for k, value in enumerate(x):
        foot = min(value + bristle.reach, max(value - bristle.reach, foot))
        out[k] = (value - foot) / bristle.reach
    return bristle.force * out


def late(wrench: Array, delay: Array, period: float) -> Array:
    """Return the channels as they were `delay` (6,) seconds ago, linear between the ticks."""
    if not delay.any():
        return wrench
    time = period * np.arange(len(wrench))
    return np.column_stack([np.interp(time - d, time, wrench[:, i]) for i, d in enumerate(delay)])
