"""Compiled loops over many poses; rows are poses."""

from __future__ import annotations

import math

import numpy as np
from sher3_common.compiled import compiled_ieee

from sher3_kinematics.kernel.blocks import pose_inverses, tip_jacobians, tip_poses
from sher3_kinematics.kernel.parameters import KernelParameters
from sher3_kinematics.kernel.robot import (
    base_is_rotated,
    delta_forward,
    delta_inverse,
    pose_inverse_into,
    tip_jacobian_into,
    tip_pose_into,
)

Array = np.ndarray


@compiled_ieee
def delta_forward_batch(p: KernelParameters, q: Array) -> Array:
    """Return the platform centres (n, 3) [m] for slider positions (n, 3) [m]."""
    centres = np.empty((q.shape[0], 3))
    for i in range(q.shape[0]):
        centres[i, 0], centres[i, 1], centres[i, 2] = delta_forward(p, q[i, 0], q[i, 1], q[i, 2])
    return centres


@compiled_ieee
def delta_inverse_batch(p: KernelParameters, centres: Array) -> Array:
    """Return the slider positions (n, 3) [m] for platform centres (n, 3) [m]."""
    q = np.empty((centres.shape[0], 3))
    for i in range(centres.shape[0]):
        q[i, 0], q[i, 1], q[i, 2] = delta_inverse(p, centres[i, 0], centres[i, 1], centres[i, 2])
    return q


@compiled_ieee
def tip_pose_batch(p: KernelParameters, q: Array) -> tuple[Array, Array]:
    """Return the tip rotations (n, 3, 3) and positions (n, 3) [m] for actuator positions (n, 5)."""
    rotations, positions = np.empty((q.shape[0], 3, 3)), np.empty((q.shape[0], 3))
    if not base_is_rotated(p):
        tip_poses(p, q, rotations, positions)
        return rotations, positions
    for i in range(q.shape[0]):
        tip_pose_into(p, q[i], rotations[i], positions[i])
    return rotations, positions


@compiled_ieee
def tip_jacobian_batch(p: KernelParameters, q: Array) -> Array:
    """Return the tip Jacobians (n, 6, 5) for actuator positions (n, 5)."""
    jacobians = np.empty((q.shape[0], 6, 5))
    if not base_is_rotated(p):
        tip_jacobians(p, q, jacobians)
        return jacobians
    for i in range(q.shape[0]):
        tip_jacobian_into(p, q[i], jacobians[i])
    return jacobians


@compiled_ieee
def pose_inverse_batch(p: KernelParameters, positions: Array, axes: Array) -> Array:
    """Return the actuator positions (n, 5) for tip positions (n, 3) [m] and distal tool axes (n, 3)."""
    q = np.empty((positions.shape[0], 5))
    if not base_is_rotated(p):
        pose_inverses(p, positions, axes, q)
        return q
    for i in range(positions.shape[0]):
        pose_inverse_into(p, positions[i, 0], positions[i, 1], positions[i, 2], axes[i], q[i])
    return q


@compiled_ieee
def tip_quaternion_batch(rotations: Array) -> Array:
    """Return unit quaternions (n, 4), x y z w with w >= 0, of rotation matrices (n, 3, 3) (Shepperd's method)."""
    quaternions = np.empty((rotations.shape[0], 4))
    for i in range(rotations.shape[0]):
        _quaternion_into(rotations[i], quaternions[i])
    return quaternions


@compiled_ieee
def _quaternion_into(r: Array, q: Array) -> None:
    trace = r[0, 0] + r[1, 1] + r[2, 2]
    best = 0
    for k in range(1, 3):
        if r[k, k] > r[best, best]:
            best = k
    if trace > r[best, best]:
        s = 2.0 * math.sqrt(1.0 + trace)
        q[0], q[1], q[2] = (r[2, 1] - r[1, 2]) / s, (r[0, 2] - r[2, 0]) / s, (r[1, 0] - r[0, 1]) / s
        q[3] = 0.25 * s
        return
    j, k = (best + 1) % 3, (best + 2) % 3
    s = 2.0 * math.sqrt(1.0 + r[best, best] - r[j, j] - r[k, k])
    w = (r[k, j] - r[j, k]) / s
    sign = 1.0 if w >= 0.0 else -1.0
    q[best] = sign * 0.25 * s
    q[j] = sign * (r[j, best] + r[best, j]) / s
    q[k] = sign * (r[k, best] + r[best, k]) / s
    q[3] = sign * w
