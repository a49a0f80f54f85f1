"""Compiled deflection of one point at one pose, for the control loop; the vectorised model is in `deflection.py`."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import compiled_ieee

Floats = NDArray[np.float64]


@compiled_ieee
def cross_add(a: Floats, b: Floats, out: Floats) -> None:
    """Add a x b to `out`, (3,) each."""
    out[0] += a[1] * b[2] - a[2] * b[1]
    out[1] += a[2] * b[0] - a[0] * b[2]
    out[2] += a[0] * b[1] - a[1] * b[0]


@compiled_ieee
def point_deflection(
    balls: Floats, feet: Floats, link: float, law: Floats, arm: Floats, centre: Floats, lever: Floats, wrench: Floats
) -> tuple[Floats, float]:
    """Return the deflection (6,) of a point under a wrench there, and the largest link force [N].

    Both are NaN out of reach.

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
    cross_add(lever, wrench[:3], load[3:])
    for i in range(6):
        unit[0] = (centre[0] + balls[i, 0] - feet[i, 0]) / link
        unit[1] = (centre[1] + balls[i, 1] - feet[i, 1]) / link
        unit[2] = math.sqrt(1.0 - unit[0] * unit[0] - unit[1] * unit[1])
        gamma[:3, i] = unit
        gamma[3:, i] = 0.0
        cross_add(balls[i], unit, gamma[3:, i])
    if not math.isfinite(gamma.sum()):
        return np.full(6, np.nan), np.nan
    forces = np.linalg.solve(gamma, load)
    largest = np.abs(forces).max()
    for i in range(6):
        forces[i] *= law[0] * (forces[i] * forces[i] + law[2]) ** (0.5 * (law[1] - 1.0))
    moved = np.linalg.solve(gamma.T.copy(), forces)
    moved[0] += arm[2] * load[0]
    moved[4] += arm[0] * load[4]
    moved[5] += arm[1] * load[5]
    cross_add(moved[3:], lever, moved[:3])
    return moved, largest
