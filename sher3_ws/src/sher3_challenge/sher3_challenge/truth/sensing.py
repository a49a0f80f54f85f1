"""What the sensors make of the truth: noise, rounding and the errors of the force sensor."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation
from sher3_description import Robot
from sher3_description.contract import EFFORT_NOISE, EFFORT_RESOLUTION, GRAVITY

from sher3_challenge.truth.hysteresis import ELEMENTS, drag_anchors, slip_state
from sher3_challenge.truth.parameters import Array, Sensors


def force_sensor(
    robot: Robot,
    p: Sensors,
    turns: Array,
    q: Array,
    contact: Array,
    kelvin: Array,
    rng: np.random.Generator,
    noise: float,
) -> Array:
    """Return (n, 6) force sensor readings in {f}.

    Args:
        robot: nominal robot, for the sensor's place, noise and resolution.
        p: the sensor as it is.
        turns: (n, 3, 3) rotation of {t} in {b}.
        q: (n, 5) true load positions, for the cable.
        contact: (n, 3) force at the tip in {b}.
        kelvin: (n,) temperature above 22 degC.
        rng: source of the noise.
        noise: 1, or 0 for a sensor without noise and rounding.
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
    spread = np.repeat([sensor.noise_force, sensor.noise_torque], 3)
    resolution = np.repeat([sensor.resolution_force, sensor.resolution_torque], 3)
    if not noise:
        return np.asarray(wrench)
    wrench += spread * rng.standard_normal(wrench.shape)
    return np.asarray(np.round(wrench / resolution) * resolution)


def _loop(x: Array, reach: float) -> Array:
    anchor = np.full(ELEMENTS, x[0])
    out = np.empty_like(x)
    for k, value in enumerate(x):
        out[k] = slip_state(value, anchor, reach)
        drag_anchors(value, anchor, reach)
    return out


def tracker(
    robot: Robot, p: Sensors, tips: Array, turns: Array, rng: np.random.Generator, noise: float
) -> tuple[Array, Array]:
    """Return tracker positions (m, 3) and quaternions (m, 4, x y z w) for the tip poses it sees."""
    spread = robot.tracker
    position = tips + p.tracker_bias + noise * spread.noise_position * rng.standard_normal(tips.shape)
    wobble = Rotation.from_rotvec(noise * spread.noise_rotation * rng.standard_normal((len(tips), 3)))
    return position, (wobble * Rotation.from_matrix(turns)).as_quat()


def effort(robot: Robot, force: Array, rng: np.random.Generator, noise: float) -> Array:
    """Return (n, 5) reported efforts: with the noise and the rounding of the contract."""
    if not noise:
        return force
    rated = np.array([actuator.drive.rated for actuator in robot.actuators])
    noisy = force + EFFORT_NOISE * rated * rng.standard_normal(force.shape)
    step = EFFORT_RESOLUTION * rated
    return np.asarray(np.round(noisy / step) * step)
