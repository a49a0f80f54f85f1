"""Tip poses and twists in the form of the topics: position and quaternion (x, y, z, w) in {b}."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import compiled
from sher3_common.vectors import Vector
from sher3_kinematics.arrays import unpack
from sher3_kinematics.kernel import tip_jacobian_into, tip_pose_into

from sher3_control.errors import CommandRejected

Array = NDArray[np.float64]
UNIT_TOLERANCE = 1e-3
"""A quaternion's length may differ from 1 by this: one rounded to four digits passes, one left at zero does not."""


def tool_axis(orientation: Vector, mode: str = "servo_cp") -> Array:
    """Return the direction of the needle, -z of {t}, in {b} (3,) for a quaternion.

    The robot has no freedom of rotation about the needle, so that part of an orientation is not used.

    Args:
        orientation: quaternion (x, y, z, w) of {t} in {b}.
        mode: CRTK name of the command, for the error.

    Raises:
        CommandRejected: the quaternion has no unit length.
    """
    x, y, z, w = orientation
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    if not abs(norm - 1.0) <= UNIT_TOLERANCE:
        raise CommandRejected(mode, "quaternion without unit length", value=norm, limit=1.0, remedy="normalise it")
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    return np.array([-2.0 * (x * z + w * y), -2.0 * (y * z - w * x), 2.0 * (x * x + y * y) - 1.0])


@compiled
def tip_pose_sample(
    parameters: Array, q: tuple[float, ...]
) -> tuple[tuple[float, float, float], tuple[float, float, float, float]]:
    """Return the tip's position [m] and unit quaternion (x, y, z, w) with w >= 0, in {b}.

    The quaternion comes by Shepperd's method (Journal of Guidance and Control 1(3), 1978), which divides by the largest
    component.

    Args:
        parameters: kernel parameters as an array (44,).
        q: actuator positions (5,).
    """
    joints = np.array(q)
    r, t = np.empty((3, 3)), np.empty(3)
    tip_pose_into(unpack(parameters), joints, r, t)
    trace = r[0, 0] + r[1, 1] + r[2, 2]
    if trace >= max(r[0, 0], r[1, 1], r[2, 2]):
        x, y, z, w = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], 1.0 + trace
    elif r[0, 0] >= max(r[1, 1], r[2, 2]):
        x, y, z, w = 1.0 + 2.0 * r[0, 0] - trace, r[0, 1] + r[1, 0], r[0, 2] + r[2, 0], r[2, 1] - r[1, 2]
    elif r[1, 1] >= r[2, 2]:
        x, y, z, w = r[0, 1] + r[1, 0], 1.0 + 2.0 * r[1, 1] - trace, r[1, 2] + r[2, 1], r[0, 2] - r[2, 0]
    else:
        x, y, z, w = r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], 1.0 + 2.0 * r[2, 2] - trace, r[1, 0] - r[0, 1]
    scale = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
    if w < 0.0:
        scale = -scale
    return (t[0], t[1], t[2]), (x * scale, y * scale, z * scale, w * scale)


@compiled
def tip_twist_sample(
    parameters: Array, q: tuple[float, ...], qd: tuple[float, ...]
) -> tuple[float, float, float, float, float, float]:
    """Return the tip's twist (linear [m/s]; angular [rad/s]) in {b}: the Jacobian at q times the actuator velocities.

    Args:
        parameters: kernel parameters as an array (44,).
        q: actuator positions (5,).
        qd: actuator velocities (5,).
    """
    jacobian, twist = np.empty((6, 5)), np.zeros(6)
    tip_jacobian_into(unpack(parameters), np.array(q), jacobian)
    for row in range(6):
        for axis in range(5):
            twist[row] += jacobian[row, axis] * qd[axis]
    return twist[0], twist[1], twist[2], twist[3], twist[4], twist[5]
