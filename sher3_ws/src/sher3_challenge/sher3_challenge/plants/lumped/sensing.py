"""What the force sensor makes of the truth: its errors and its cable."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter
from sher3_description import Robot
from sher3_description.contract import GRAVITY

from sher3_challenge.plants.lumped.hysteresis import ELEMENTS, drag_anchors, slip_state
from sher3_challenge.plants.lumped.parameters import Array, Sensors


def force_sensor(
    robot: Robot,
    p: Sensors,
    turns: Array,
    q: Array,
    contact: Array,
    kelvin: Array,
) -> Array:
    """Return (n, 6) what the force sensor would read in {f} without noise and rounding.

    Args:
        robot: nominal robot, for the sensor's place.
        p: the sensor as it is.
        turns: (n, 3, 3) rotation of {t} in {b}.
        q: (n, 5) true load positions, for the cable.
        contact: (n, 3) force at the tip in {b}.
        kelvin: (n,) temperature above 22 degC.
    """
    sensor = robot.force_sensor
    force = np.einsum("nji,nj->ni", turns, contact)
    weight = -p.tool_mass[0] * GRAVITY * turns[:, 2, :]
    torque = np.cross(-np.asarray(sensor.position), force) + np.cross(p.tool_com, weight)
    wrench = np.hstack([force + weight, torque])
    wrench[:, 0] += p.cable_force[1] * q[:, 4] / robot.tilt_linkage.crank
    wrench[:, 1] += p.cable_force[0] * q[:, 3] + p.cable_force[2] * _loop(q[:, 3], p.cable_force[3])
    wrench = p.force_scale[0] * wrench @ p.crosstalk.T + p.force_bias + np.outer(kelvin, p.force_drift)
    if p.force_lag[0] > 0.0:
        keep = np.exp(-robot.control_period / p.force_lag[0])
        wrench = lfilter([1 - keep], [1, -keep], wrench, axis=0, zi=keep * wrench[:1])[0]
    return np.asarray(wrench)


def _loop(x: Array, reach: float) -> Array:
    anchor = np.full(ELEMENTS, x[0])
    out = np.empty_like(x)
    for k, value in enumerate(x):
        out[k] = slip_state(value, anchor, reach)
        drag_anchors(value, anchor, reach)
    return out
