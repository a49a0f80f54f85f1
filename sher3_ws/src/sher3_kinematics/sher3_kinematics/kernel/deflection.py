"""Compiled deflection of one point at one pose, for the control loop; the vectorised model is in `deflection.py`."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import compiled_ieee

from sher3_kinematics.kernel.parameters import unpack
from sher3_kinematics.kernel.robot import delta_forward, tip_pose_into

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@compiled_ieee
def cross_add(a: Floats, b: Floats, out: Floats) -> None:
    """Add a x b to `out`, (3,) each."""
    out[0] += a[1] * b[2] - a[2] * b[1]
    out[1] += a[2] * b[0] - a[0] * b[2]
    out[2] += a[0] * b[1] - a[1] * b[0]


@compiled_ieee
def factorise(a: Floats, order: Integers) -> bool:
    """Factorise a (6, 6) in place, L and U in one array, rows exchanged as in `order` (6,); False if it is singular.

    Gauss with partial pivoting (Golub, Van Loan, "Matrix Computations", 4th ed., algorithm 3.4.1). Written out since at
    this size a call of the linear algebra library takes longer than all of it.
    """
    for k in range(6):
        order[k] = k
    for k in range(6):
        best = k
        for i in range(k + 1, 6):
            if abs(a[i, k]) > abs(a[best, k]):
                best = i
        if not abs(a[best, k]) > 0.0:
            return False
        if best != k:
            order[k], order[best] = order[best], order[k]
            for j in range(6):
                a[k, j], a[best, j] = a[best, j], a[k, j]
        inverse = 1.0 / a[k, k]
        for i in range(k + 1, 6):
            a[i, k] *= inverse
            for j in range(k + 1, 6):
                a[i, j] -= a[i, k] * a[k, j]
    return True


@compiled_ieee
def solve(lu: Floats, order: Integers, b: Floats, x: Floats) -> None:
    """Write the solution x (6,) of A x = b for the factors of A."""
    for i in range(6):
        total = b[order[i]]
        for j in range(i):
            total -= lu[i, j] * x[j]
        x[i] = total
    for i in range(5, -1, -1):
        total = x[i]
        for j in range(i + 1, 6):
            total -= lu[i, j] * x[j]
        x[i] = total / lu[i, i]


@compiled_ieee
def solve_transposed(lu: Floats, order: Integers, b: Floats, x: Floats) -> None:
    """Write the solution x (6,) of A^T x = b for the factors of A; b is used up."""
    for i in range(6):
        total = b[i]
        for j in range(i):
            total -= lu[j, i] * b[j]
        b[i] = total / lu[i, i]
    for i in range(5, -1, -1):
        total = b[i]
        for j in range(i + 1, 6):
            total -= lu[j, i] * b[j]
        b[i] = total
        x[order[i]] = total


@compiled_ieee
def point_deflection(
    balls: Floats, feet: Floats, link: float, law: Floats, arm: Floats, centre: Floats, lever: Floats, wrench: Floats
) -> tuple[Floats, float]:
    """Return the deflection (6,) of a point under a wrench there, and the largest link force [N].

    Both are NaN out of reach and at a singularity.

    Args:
        balls: Platform ball centres in {p} (6, 3) [m].
        feet: Base ball centres (6, 3) [m]; their height does not matter.
        link: Link length [m].
        law: Link law (a factor, b, floor^2).
        arm: 1 / pitch, 1 / yaw [rad/(N m)] and compliance along x [m/N], in series with the delta.
        centre: Platform centre (3,) [m].
        lever: Vector from the platform centre to the point (3,) [m].
        wrench: Force and moment (6,) at the point [N, N m].
    """
    gamma, unit, load = np.empty((6, 6)), np.empty(3), wrench.copy()
    forces, moved, order = np.empty(6), np.empty(6), np.empty(6, np.int64)
    cross_add(lever, wrench[:3], load[3:])
    for i in range(6):
        unit[0] = (centre[0] + balls[i, 0] - feet[i, 0]) / link
        unit[1] = (centre[1] + balls[i, 1] - feet[i, 1]) / link
        unit[2] = math.sqrt(1.0 - unit[0] * unit[0] - unit[1] * unit[1])
        for k in range(3):
            gamma[k, i], gamma[3 + k, i] = unit[k], 0.0
        cross_add(balls[i], unit, gamma[3:, i])
    if not factorise(gamma, order):
        return np.full(6, np.nan), np.nan
    solve(gamma, order, load, forces)
    largest = 0.0
    for i in range(6):
        largest = max(largest, abs(forces[i])) if forces[i] == forces[i] else np.nan
        forces[i] *= law[0] * (forces[i] * forces[i] + law[2]) ** (0.5 * (law[1] - 1.0))
    solve_transposed(gamma, order, forces, moved)
    moved[0] += arm[2] * load[0]
    moved[4] += arm[0] * load[4]
    moved[5] += arm[1] * load[5]
    cross_add(moved[3:], lever, moved[:3])
    return moved, largest


@compiled_ieee
def tip_deflection(
    parameters: Floats, q: Floats, wrench: Floats, balls: Floats, feet: Floats, constants: Floats
) -> tuple[Floats, bool]:
    """Return the deflection (6,) of the tip under a wrench (6,) there, and whether it may be used.

    It may not where the pose does not exist, links carry absurd forces, or the sensor cannot measure the load.

    Args:
        parameters: See `arrays.unpack`.
        q: Actuator positions (5,).
        wrench: Force and moment (6,) in {b} [N, N m].
        balls: See `point_deflection`.
        feet: See `point_deflection`.
        constants: Link length, link law (3,), arm (3,), range of the sensor (6,), its position in {t} (3,), absurd link
            force: (17,) together.
    """
    p = unpack(parameters)
    rotation, tip, lever, force, moment = np.empty((3, 3)), np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    tip_pose_into(p, q, rotation, tip)
    centre = np.array(delta_forward(p, q[0], q[1], q[2]))
    for k in range(3):
        lever[k] = tip[k] - centre[k]
        force[k] = rotation[0, k] * wrench[0] + rotation[1, k] * wrench[1] + rotation[2, k] * wrench[2]
        moment[k] = rotation[0, k] * wrench[3] + rotation[1, k] * wrench[4] + rotation[2, k] * wrench[5]
    cross_add(force, constants[13:16], moment)
    measurable = True
    for k in range(3):
        measurable = measurable and abs(force[k]) <= constants[7 + k] and abs(moment[k]) <= constants[10 + k]
    law, arm = constants[1:4], constants[4:7]
    moved, largest = point_deflection(balls, feet, constants[0], law, arm, centre, lever, wrench)
    return moved, measurable and largest < constants[16]
