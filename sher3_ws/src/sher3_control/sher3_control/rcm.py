"""Virtual remote centre of motion: the tool's shaft keeps passing through a point, as through the sclera.

With s the shaft point nearest the centre c and B the two unit vectors across the shaft, J_s = J_v - [s - p]x J_w
moves s, and

    B' J_s qd = -k B' (s - c) - h

leaves three of the five directions free: two rotations about c and the insertion. Among them the actuator velocity is
the one whose tip twist is nearest the request, with `LENGTH` weighing rotation against translation. The linear
constraint alone lets the shaft drift by the curvature of one step, so the step's end is predicted with the full
kinematics and the remainder taken out by one Newton correction.

The drives give way to a load that changes: with gravity G on an axis they are slow by G'/ki, and while the robot turns
that pushes the shaft off at tens of um/s, against which k alone leaves tenths of um. The hold h, the integral of the
deviation, takes it up.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sher3_kinematics.arrays import unpack
from sher3_kinematics.kernel import tip_jacobian_into, tip_pose_into

from .compiled import compiled

Array = NDArray[np.float64]
Hold = tuple[float, float]
NO_HOLD: Hold = (0.0, 0.0)

PULL_LIMIT = 1e-3
"""Fastest approach [m/s] of a shaft that is off the centre."""
HOLD_LIMIT = 3e-4
"""Largest hold [m/s], per axis across the shaft: three times what the nominal loads need at the fastest turn."""
LENGTH = 0.02
"""Lever [m] that makes rad/s and m/s comparable: about the depth of the tip behind the sclera."""


@compiled
def shaft_deviation(rotation: Array, position: Array, centre: Array) -> tuple[float, float, float]:
    """Return how far the shaft passes from the centre along x and y of {t}, and the depth of the tip beyond it [m]."""
    d = position - centre
    across_x = rotation[0, 0] * d[0] + rotation[1, 0] * d[1] + rotation[2, 0] * d[2]
    across_y = rotation[0, 1] * d[0] + rotation[1, 1] * d[1] + rotation[2, 1] * d[2]
    depth = -(rotation[0, 2] * d[0] + rotation[1, 2] * d[1] + rotation[2, 2] * d[2])
    return across_x, across_y, depth


@compiled
def _constraint_rows(jacobian: Array, rotation: Array, depth: float, rows: Array) -> None:
    """Write B' J_s (2, 5); the shaft point lies at `depth` along z of {t} from the tip."""
    for k in range(5):
        vx = vy = wx = wy = 0.0
        for i in range(3):
            vx += rotation[i, 0] * jacobian[i, k]
            vy += rotation[i, 1] * jacobian[i, k]
            wx += rotation[i, 0] * jacobian[3 + i, k]
            wy += rotation[i, 1] * jacobian[3 + i, k]
        rows[0, k] = vx + depth * wy
        rows[1, k] = vy - depth * wx


@compiled
def _saddle(jacobian: Array, rows: Array) -> Array:
    """Return the matrix (7, 7) of the constrained least squares: [J'WJ A'; A 0]."""
    matrix = np.zeros((7, 7))
    for a in range(5):
        for b in range(5):
            for i in range(3):
                matrix[a, b] += jacobian[i, a] * jacobian[i, b]
                matrix[a, b] += LENGTH * LENGTH * jacobian[3 + i, a] * jacobian[3 + i, b]
        for r in range(2):
            matrix[a, 5 + r] = rows[r, a]
            matrix[5 + r, a] = rows[r, a]
    return matrix


@compiled
def rcm_velocity(
    parameters: Array, q: Array, twist: Array, centre: Array, hold: Hold, gain: float, period: float
) -> tuple[Array, float, float]:
    """Return actuator velocities (5,) that keep the shaft on the centre, and how far it is off [m], x and y of {t}.

    Args:
        parameters: geometry of the robot, the kernel parameters as an array (44,).
        q: measured actuator positions (5,).
        twist: requested tip twist (6,) in {b}.
        centre: the remote centre (3,) [m] in {b}.
        hold: velocity [m/s] along x and y of {t} that something else moves the shaft with, to be held against.
        gain: rate at which a deviation decays [1/s].
        period: time for which the velocity will be held [s].

    Raises:
        LinAlgError: the robot is singular here.
    """
    p = unpack(parameters)
    rotation, position = np.empty((3, 3)), np.empty(3)
    jacobian, rows = np.empty((6, 5)), np.empty((2, 5))
    tip_pose_into(p, q, rotation, position)
    tip_jacobian_into(p, q, jacobian)
    x, y, depth = shaft_deviation(rotation, position, centre)
    _constraint_rows(jacobian, rotation, depth, rows)
    matrix = _saddle(jacobian, rows)
    right = np.zeros(7)
    for a in range(5):
        for i in range(3):
            right[a] += jacobian[i, a] * twist[i] + LENGTH * LENGTH * jacobian[3 + i, a] * twist[3 + i]
    deviation = np.hypot(x, y)
    pull = min(gain, PULL_LIMIT / deviation) if deviation > 0.0 else gain
    back_x, back_y = -pull * x - hold[0], -pull * y - hold[1]
    right[5], right[6] = back_x, back_y
    velocity = np.linalg.solve(matrix, right)[:5]
    tip_pose_into(p, q + period * velocity, rotation, position)
    end_x, end_y, _ = shaft_deviation(rotation, position, centre)
    right[:5] = 0.0
    right[5], right[6] = (x - end_x) / period + back_x, (y - end_y) / period + back_y
    return velocity + np.linalg.solve(matrix, right)[:5], x, y


def next_hold(hold: Hold, x: float, y: float, rate: float, period: float) -> Hold:
    """Return the hold [m/s] after a period with the shaft off by x, y [m]; it grows at `rate` [1/s^2]."""
    step = rate * period
    return (
        min(max(hold[0] + step * x, -HOLD_LIMIT), HOLD_LIMIT),
        min(max(hold[1] + step * y, -HOLD_LIMIT), HOLD_LIMIT),
    )
