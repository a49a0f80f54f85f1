"""Kinematics of many poses in blocks, four or eight by one instruction, for a robot whose base is not rotated.

A block's numbers lie side by side by kind. Robots with a rotated base go pose by pose (`batch`).

A block is one flat array; kind k of pose i is at `k * LANES + i`. The offsets are constants, from which the compiler
sees that no store touches a later load.
"""

from __future__ import annotations

import math

import numpy as np
from sher3_common.compiled import compiled_ieee

from sher3_kinematics.kernel.delta import leg_vectors, stage_columns, stage_forward, stage_inverse
from sher3_kinematics.kernel.lanes import direction_angle, sine_cosine
from sher3_kinematics.kernel.parameters import KernelParameters
from sher3_kinematics.kernel.robot import arm_vector
from sher3_kinematics.kernel.tilt import slider_height, tilt_sine_cosine, tilt_slope

Array = np.ndarray
LANES = 128
"""Poses in a block: 16 to 27 kinds of 1 KiB stay in the fastest memory."""


@compiled_ieee
def _pose(p: KernelParameters, w: Array) -> None:
    """Positions and rotations of a block: q in kinds 0 to 4; x y z, cos and sin of tilt, products with roll behind."""
    n = LANES
    for i in range(n):
        x, y, z = stage_forward(p, w[i], w[n + i], w[2 * n + i])
        sa, ca = sine_cosine(w[3 * n + i] + p.zero_4)
        st, ct = tilt_sine_cosine(p, w[4 * n + i])
        arm, _ = arm_vector(p, sa, ca, st, ct)
        w[5 * n + i], w[6 * n + i], w[7 * n + i] = x + arm[0], y + arm[1], z + p.d1 + arm[2]
        w[8 * n + i], w[9 * n + i], w[10 * n + i], w[11 * n + i] = ct, st, ca, sa
        w[12 * n + i], w[13 * n + i], w[14 * n + i], w[15 * n + i] = sa * st, -sa * ct, -ca * st, ca * ct


@compiled_ieee
def tip_poses(p: KernelParameters, q: Array, rotations: Array, positions: Array) -> None:
    """Write tip rotations (n, 3, 3) and positions (n, 3) for q (n, 5); see `robot.tip_pose_into`."""
    w, n = np.zeros(16 * LANES), LANES
    for begin in range(0, q.shape[0], n):
        count = min(n, q.shape[0] - begin)
        for i in range(count):
            for k in range(5):
                w[k * n + i] = q[begin + i, k]
        _pose(p, w)
        for i in range(count):
            position, rotation = positions[begin + i], rotations[begin + i]
            position[0], position[1], position[2] = w[5 * n + i], w[6 * n + i], w[7 * n + i]
            rotation[0, 0], rotation[0, 1], rotation[0, 2] = w[8 * n + i], 0.0, w[9 * n + i]
            rotation[1, 0], rotation[1, 1], rotation[1, 2] = w[12 * n + i], w[10 * n + i], w[13 * n + i]
            rotation[2, 0], rotation[2, 1], rotation[2, 2] = w[14 * n + i], w[11 * n + i], w[15 * n + i]


@compiled_ieee
def _jacobian(p: KernelParameters, w: Array) -> None:
    """Jacobians of a block: q in kinds 0 to 4; the 16 entries that are not constant behind."""
    n = LANES
    for i in range(n):
        _, n1, n2, n3 = leg_vectors(p, w[i], w[n + i], w[2 * n + i])
        c1, c2, c3 = stage_columns(p, n1, n2, n3)
        sa, ca = sine_cosine(w[3 * n + i] + p.zero_4)
        st, ct = tilt_sine_cosine(p, w[4 * n + i])
        arm, tilt = arm_vector(p, sa, ca, st, ct)
        rate = 1.0 / tilt_slope(p, st, ct)
        w[5 * n + i], w[6 * n + i], w[7 * n + i] = c1
        w[8 * n + i], w[9 * n + i], w[10 * n + i] = c2
        w[11 * n + i], w[12 * n + i], w[13 * n + i] = c3
        w[14 * n + i], w[15 * n + i] = -arm[2], arm[1]
        w[16 * n + i] = (ca * tilt[2] - sa * tilt[1]) * rate
        w[17 * n + i], w[18 * n + i] = sa * tilt[0] * rate, -ca * tilt[0] * rate
        w[19 * n + i], w[20 * n + i] = ca * rate, sa * rate


@compiled_ieee
def tip_jacobians(p: KernelParameters, q: Array, jacobians: Array) -> None:
    """Write the Jacobians (n, 6, 5) for q (n, 5); see `robot.tip_jacobian_into`."""
    w, n = np.zeros(21 * LANES), LANES
    for begin in range(0, q.shape[0], n):
        count = min(n, q.shape[0] - begin)
        for i in range(count):
            for k in range(5):
                w[k * n + i] = q[begin + i, k]
        _jacobian(p, w)
        for i in range(count):
            j = jacobians[begin + i]
            for row in range(3):
                for k in range(3):
                    j[row, k] = w[(5 + 3 * k + row) * n + i]
                j[3 + row, 0], j[3 + row, 1], j[3 + row, 2] = 0.0, 0.0, 0.0
                j[row, 4] = w[(16 + row) * n + i]
            j[0, 3], j[1, 3], j[2, 3] = 0.0, w[14 * n + i], w[15 * n + i]
            j[3, 3], j[4, 3], j[5, 3] = 1.0, 0.0, 0.0
            j[3, 4], j[4, 4], j[5, 4] = 0.0, w[19 * n + i], w[20 * n + i]


@compiled_ieee
def _inverse(p: KernelParameters, w: Array) -> None:
    """Actuator positions of a block: tip x y z and tool axis in kinds 0 to 5, q behind."""
    n = LANES
    height = slider_height(p, 0.0)
    for i in range(n):
        ax, ay, az = w[3 * n + i], w[4 * n + i], w[5 * n + i]
        level = math.sqrt(ay * ay + az * az)
        length = math.sqrt(ax * ax + level * level)
        st, ct = -ax / length, level / length
        sa, ca = ay / level, -az / level
        arm, _ = arm_vector(p, sa, ca, st, ct)
        x, y, z = w[i] - arm[0], w[n + i] - arm[1], w[2 * n + i] - p.d1 - arm[2]
        reach = p.offset - p.crank * ct
        w[6 * n + i], w[7 * n + i], w[8 * n + i] = stage_inverse(p, x, y, z)
        w[9 * n + i] = direction_angle(sa, ca) - p.zero_4
        w[10 * n + i] = p.crank * st + math.sqrt(p.coupler * p.coupler - reach * reach) - height


@compiled_ieee
def pose_inverses(p: KernelParameters, positions: Array, axes: Array, q: Array) -> None:
    """Write q (n, 5) for tip positions (n, 3) and tool axes (n, 3); see `robot.pose_inverse_into`."""
    w, n = np.zeros(11 * LANES), LANES
    for begin in range(0, q.shape[0], n):
        count = min(n, q.shape[0] - begin)
        for i in range(count):
            for k in range(3):
                w[k * n + i], w[(3 + k) * n + i] = positions[begin + i, k], axes[begin + i, k]
        _inverse(p, w)
        for i in range(count):
            for k in range(5):
                q[begin + i, k] = w[(6 + k) * n + i]
