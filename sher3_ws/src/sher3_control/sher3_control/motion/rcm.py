"""Virtual remote centre of motion: the tool's shaft keeps passing through one point, as through the sclera.

Let p be the tip, s the point of the shaft nearest to the centre c, and B the two unit vectors across the shaft. The
Jacobian of s is J_s = J_v - [s - p]x J_w, and the constraint is

    B' J_s qd = -k B' (s - c) - h

It leaves three of the five directions free: two rotations about c and the insertion. Among the velocities that fulfil
it, the one is taken whose tip twist is nearest to the request; `LENGTH` weighs rotation against translation.

The constraint is linear, so alone it lets the shaft drift by the curvature of each step. Therefore the full kinematics
predict where the shaft will be at the end of the step, and one Newton correction takes out what is left.

The drives give way to a load that changes: an axis that carries the weight G is slow by G'/ki. While the robot turns,
this pushes the shaft off at tens of um/s, and the gain k alone would leave tenths of um. The hold h, the integral of
the deviation, takes it up.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import compiled
from sher3_kinematics.arrays import unpack
from sher3_kinematics.kernel import tip_jacobian_into, tip_pose_into

Array = NDArray[np.float64]
Hold = tuple[float, float]
"""Velocity along x and y of {t} that the law holds against a steady push [m/s]."""
NO_HOLD: Hold = (0.0, 0.0)

PULL_LIMIT = 1e-3
"""Fastest approach [m/s] of a shaft that is off the centre."""
HOLD_LIMIT = 3e-4
"""Largest hold per axis across the shaft [m/s]: three times what the nominal loads need at the fastest turn."""
LENGTH = 0.02
"""Lever that makes rad/s and m/s comparable [m]: about the depth of the tip behind the sclera."""


@compiled
def shaft_deviation(rotation: Array, position: Array, centre: Array) -> tuple[float, float, float]:
    """Return by how much the shaft misses the centre along x and y of {t}, and how deep the tip is behind it [m].

    Args:
        rotation: of {t} in {b}, (3, 3).
        position: of the tip (3,) [m] in {b}.
        centre: the remote centre (3,) [m] in {b}.
    """
    d = position - centre
    across_x = rotation[0, 0] * d[0] + rotation[1, 0] * d[1] + rotation[2, 0] * d[2]
    across_y = rotation[0, 1] * d[0] + rotation[1, 1] * d[1] + rotation[2, 1] * d[2]
    depth = -(rotation[0, 2] * d[0] + rotation[1, 2] * d[1] + rotation[2, 2] * d[2])
    return across_x, across_y, depth


@compiled
def _constraint_rows(jacobian: Array, rotation: Array, depth: float, rows: Array) -> None:
    """Write B' J_s (2, 5) into `rows`; the shaft point lies `depth` [m] along z of {t} from the tip."""
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
def _weighted_request(jacobian: Array, twist: Array, right: Array) -> None:
    """Write J'W twist (5,) into the first rows of the right-hand side."""
    for a in range(5):
        for i in range(3):
            right[a] += jacobian[i, a] * twist[i] + LENGTH * LENGTH * jacobian[3 + i, a] * twist[3 + i]


@compiled
def rcm_velocity(
    parameters: Array, q: Array, twist: Array, centre: Array, hold: Hold, gain: float, period: float
) -> tuple[Array, float, float]:
    """Return actuator velocities (5,) that keep the shaft on the centre, and by how much it misses it now.

    The second and third result are the deviation along x and y of {t} [m].

    Args:
        parameters: geometry of the robot, the kernel parameters as an array (44,).
        q: measured actuator positions (5,).
        twist: requested tip twist (6,) in {b}.
        centre: the remote centre (3,) [m] in {b}.
        hold: velocity along x and y of {t} to hold against a steady push [m/s].
        gain: rate k at which a deviation decays [1/s].
        period: time for which the velocity will last [s].

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
    _weighted_request(jacobian, twist, right)
    deviation = np.hypot(x, y)
    pull = min(gain, PULL_LIMIT / deviation) if deviation > 0.0 else gain
    back_x, back_y = -pull * x - hold[0], -pull * y - hold[1]
    right[5], right[6] = back_x, back_y
    velocity = np.linalg.solve(matrix, right)[:5]
    # The Newton correction: what the full kinematics predict beyond the linear constraint is taken back.
    tip_pose_into(p, q + period * velocity, rotation, position)
    end_x, end_y, _ = shaft_deviation(rotation, position, centre)
    right[:5] = 0.0
    right[5], right[6] = (x - end_x) / period + back_x, (y - end_y) / period + back_y
    return velocity + np.linalg.solve(matrix, right)[:5], x, y


def next_hold(hold: Hold, x: float, y: float, rate: float, period: float) -> Hold:
    """Return the hold after a period [s] in which the shaft was off by x and y [m]; it grows at `rate` [1/s^2]."""
    step = rate * period
    return (
        min(max(hold[0] + step * x, -HOLD_LIMIT), HOLD_LIMIT),
        min(max(hold[1] + step * y, -HOLD_LIMIT), HOLD_LIMIT),
    )
