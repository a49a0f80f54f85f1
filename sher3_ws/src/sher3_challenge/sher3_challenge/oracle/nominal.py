"""The nominal equations of the recorded-run contract (sections 2 and 3), vectorised over ticks and written once more.

The challenge judges with them, so they must not come from the code that is judged.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from sher3_description import Robot
from sher3_description.contract import GRAVITY

Array = NDArray[np.floating[Any]]


def platform_centre(robot: Robot, q: Array) -> Array:
    """Return (n, 3) the platform centre for slider positions (n, >=3): intersection of three spheres, upper root."""
    delta = robot.delta
    azimuth = np.asarray(delta.leg_azimuth)
    s = q[:, :3] + delta.slider_zero
    centres = np.stack(
        [
            np.tile(delta.leg_offset * np.cos(azimuth), (len(q), 1)),
            np.tile(delta.leg_offset * np.sin(azimuth), (len(q), 1)),
            s,
        ],
        axis=2,
    )
    a, b, c = centres[:, 0], centres[:, 1], centres[:, 2]
    x = b - a
    d = np.linalg.norm(x, axis=1, keepdims=True)
    x = x / d
    i = np.sum(x * (c - a), axis=1, keepdims=True)
    y = c - a - i * x
    j = np.linalg.norm(y, axis=1, keepdims=True)
    y = y / j
    u = d / 2
    w = (i * i + j * j) / (2 * j) - i / j * u
    height = np.sqrt(delta.link_length**2 - u * u - w * w)
    return a + u * x + w * y + height * np.cross(x, y)


def tilt_angle(robot: Robot, q: Array) -> Array:
    """Return (n,) the tilt angle for the tilt slider's travel (n,): closed form of the offset slider-crank."""
    r, c, e = robot.tilt_linkage.crank, robot.tilt_linkage.coupler, robot.tilt_linkage.offset
    x = q + np.sqrt(c * c - (e - r) ** 2)
    # r sin a + sqrt(c^2 - (e - r cos a)^2) = x  <=>  x sin a + e cos a = (x^2 + e^2 + r^2 - c^2) / (2 r)
    k = (x * x + e * e + r * r - c * c) / (2 * r)
    return np.asarray(np.arcsin(k / np.hypot(x, e)) - np.arctan2(e, x))


def turned(robot: Robot, q: Array, rolled: Any, tilted: Any) -> Array:
    """Return (n, 3) a point of the roll part plus a vector of the tilt part, both (3,), turned as q (n, 5) says.

    Written out, because most of a case's cost would be products of rotations: the tilt about y, then the roll about x.
    """
    a, b = q[:, 3], tilt_angle(robot, q[:, 4])
    x = rolled[0] + np.cos(b) * tilted[0] + np.sin(b) * tilted[2]
    y = rolled[1] + tilted[1]
    z = rolled[2] - np.sin(b) * tilted[0] + np.cos(b) * tilted[2]
    return np.column_stack([x, np.cos(a) * y - np.sin(a) * z, np.sin(a) * y + np.cos(a) * z])


def tip_position(robot: Robot, q: Array) -> Array:
    """Return tip positions (n, 3) in {b} for actuator positions (n, 5)."""
    arm = robot.arm
    lifted = platform_centre(robot, q) + np.array([0.0, 0.0, arm.d1])
    return np.asarray(lifted + turned(robot, q, [arm.d2, 0.0, arm.d3], arm.tool))


def tip_pose(robot: Robot, q: Array) -> tuple[Array, Rotation]:
    """Return tip positions (n, 3) in {b} and rotations for actuator positions (n, 5)."""
    roll = Rotation.from_rotvec(np.column_stack([q[:, 3], np.zeros((len(q), 2))]))
    angle = tilt_angle(robot, q[:, 4])
    tilt = Rotation.from_rotvec(np.column_stack([np.zeros(len(q)), angle, np.zeros(len(q))]))
    return tip_position(robot, q), roll * tilt


def tip_jacobian(robot: Robot, q: Array) -> Array:
    """Return (n, 3, 5) the Jacobian from actuator velocities to the tip's linear velocity, by central differences."""
    return np.stack(slopes(lambda at: tip_position(robot, at), q, 1e-6), axis=2)


def slopes(of: Callable[[Array], Array], q: Array, step: float) -> list[Array]:
    """Return the derivatives of a function of (n, 5) positions along each of the five, by central differences."""
    return [(of(q + d) - of(q - d)) / (2 * step) for d in step * np.eye(5)]


def potential(robot: Robot, q: Array) -> Array:
    """Return (n,) the potential energy [J] of platform, roll part and tilt part, each on its own axes."""
    arm = robot.arm
    height = robot.delta.moving_mass * platform_centre(robot, q)[:, 2]
    height = height + arm.roll_mass * turned(robot, q, arm.roll_com, [0.0, 0.0, 0.0])[:, 2]
    height = height + arm.tilt_mass * turned(robot, q, [arm.d2, 0.0, arm.d3], arm.tilt_com)[:, 2]
    return np.asarray(GRAVITY * height)


def gravity(robot: Robot, q: Array) -> Array:
    """Return (n, 5) the gravity force G(q) that the drives hold, by central differences of the potential."""
    return np.column_stack(slopes(lambda at: potential(robot, at), q, 1e-5))


def force_reading(robot: Robot, rotation: Rotation, contact: Array) -> Array:
    """Return (n, 6) the nominal force sensor reading in {f} for a force (n, 3) in {b} on the tip."""
    sensor = robot.force_sensor
    force = rotation.apply(contact, inverse=True)
    weight = rotation.apply([0.0, 0.0, -sensor.tool_mass * GRAVITY], inverse=True)
    torque = np.cross(-np.asarray(sensor.position), force) + np.cross(sensor.tool_com, weight)
    return np.hstack([force + weight, torque])
