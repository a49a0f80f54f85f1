"""What the force sensor makes of the truth: matrix, zero, cable, late channels, hysteresis."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter
from sher3_description import Robot
from sher3_description.contract import GRAVITY

from sher3_challenge.plants.plant import Array
from sher3_challenge.plants.tables.curves import CURVE
from sher3_challenge.plants.tables.parameters import Sensor, TableParameters
from sher3_challenge.plants.tables.tip import FULL_FORCE, turned_over

LOOP_REACH = 0.5
"""Force over which the hysteresis of the sensor turns [N]."""


def force_reading(robot: Robot, p: TableParameters, turns: Array, q: Array, contact: Array, kelvin: Array) -> Array:
    """Return (n, 6) readings in {f} without noise and rounding.

    Args:
        robot: the robot file, for the sensor's place.
        p: the robot as it is.
        turns: (n, 3, 3) rotation of {t} in {b}.
        q: (n, 5) true load positions, for the cable.
        contact: (n, 3) force at the tip in {b}.
        kelvin: (n,) the body's temperature above 22 degC.
    """
    s = p.sensor
    force = np.einsum("nji,nj->ni", turns, contact)
    weight = -s.tool_mass[0] * GRAVITY * turns[:, 2, :]
    torque = np.cross(-np.asarray(robot.force_sensor.position), force) + np.cross(s.tool_com, weight)
    wrench = np.hstack([force + weight, torque])
    angle = np.linspace(-1.0, 1.0, CURVE)
    wrench[:, 1] += np.interp(q[:, 3], angle, s.cable[0])
    wrench[:, 0] += np.interp(q[:, 4] / robot.tilt_linkage.crank, angle, s.cable[1])
    if s.cable_loop[0] != 0.0:
        wrench[:, 1] += s.cable_loop[0] * turned_over(np.ascontiguousarray(q[:, 3]), s.cable_loop[1], p.motor.slope[3])
    return _filtered(s, _measured(p, wrench, kelvin), robot.control_period)


def _measured(p: TableParameters, wrench: Array, kelvin: Array) -> Array:
    s = p.sensor
    own = np.diag(np.diag(s.matrix))
    less = 1.0 - s.saturation[0] * np.minimum(1.0, np.abs(wrench) / FULL_FORCE)
    read = wrench @ own.T + (wrench * less) @ (s.matrix - own).T
    if s.loop[0] != 0.0:
        for a in range(3):
            state = turned_over(np.ascontiguousarray(wrench[:, a]), LOOP_REACH, p.motor.slope[a])
            read[:, a] -= s.loop[0] * LOOP_REACH * state
    return np.asarray(read + s.bias + np.outer(kelvin, s.drift))


def _filtered(s: Sensor, wrench: Array, period: float) -> Array:
    """Return the readings through two equal poles for every channel that is late."""
    out = wrench.copy()
    for channel, constant in enumerate(s.late):
        if constant > 0.0:
            keep = np.exp(-2 * period / constant)
            for _ in range(2):
                first = out[:1, channel]
                out[:, channel] = lfilter([1 - keep], [1, -keep], out[:, channel], zi=keep * first)[0]
    return out
