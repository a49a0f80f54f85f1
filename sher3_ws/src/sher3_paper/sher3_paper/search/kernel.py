"""Compiled conditioning index and torsional compliance of many designs over many poses.

With vertical rails both depend on the horizontal position alone. Leg k has the vector u_k = (P_xy - R e_k, h_k) of
length L and the sideways direction t_k, at right angles to e_k.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import compiled_ieee

Floats = NDArray[np.float64]


@compiled_ieee
def conditioning(ux: Floats, uy: Floats, uz: Floats) -> float:
    """Return sigma_min / sigma_max of the inverse Jacobian, rows (u_x / u_z, u_y / u_z, 1), (3,) each.

    The singular values are square roots of the eigenvalues of a symmetric 3 x 3 matrix, in trigonometric closed form
    (O. K. Smith, "Eigenvalues of a symmetric 3 x 3 matrix", Comm. ACM 4(4), 1961).
    """
    a, b, c, d, e = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        x, y = ux[k] / uz[k], uy[k] / uz[k]
        a, b, c, d, e = a + x * x, b + y * y, c + x * y, d + x, e + y
    mean = (a + b + 3.0) / 3.0
    p, q, r = a - mean, b - mean, 3.0 - mean
    spread = math.sqrt((p * p + q * q + r * r + 2.0 * (c * c + d * d + e * e)) / 6.0)
    if spread == 0.0:
        return 1.0
    determinant = p * (q * r - e * e) - c * (c * r - e * d) + d * (c * e - q * d)
    angle = math.acos(min(1.0, max(-1.0, determinant / (2.0 * spread**3)))) / 3.0
    largest = mean + 2.0 * spread * math.cos(angle)
    smallest = mean + 2.0 * spread * math.cos(angle + 2.0 * math.pi / 3.0)
    return math.sqrt(max(smallest, 0.0) / largest)


@compiled_ieee
def torsion(moments: Floats, torque: float, law: Floats) -> float:
    """Return rotation about z over torque [rad/(N m)] under a moment about z.

    Without a force on the platform the two links of a leg carry +f_k and -f_k. With the rows m_k = (w / L) t_k x u_k of
    `moments` (3, 3) the moment is sum m_k f_k, and by virtual work m_k . rotation = 2 dL(f_k): two 3 x 3 systems with
    transposed matrices, eqs. (6) and (12) of the paper restricted to pure moments. `law` is (a factor, b, floor^2).
    """
    c0 = moments[1, 0] * moments[2, 1] - moments[1, 1] * moments[2, 0]
    c1 = moments[2, 0] * moments[0, 1] - moments[2, 1] * moments[0, 0]
    c2 = moments[0, 0] * moments[1, 1] - moments[0, 1] * moments[1, 0]
    determinant = moments[0, 2] * c0 + moments[1, 2] * c1 + moments[2, 2] * c2
    rotation = 0.0
    for cofactor in (c0, c1, c2):
        share = cofactor / determinant
        force = torque * share
        rotation += 2.0 * law[0] * force * (force * force + law[2]) ** (0.5 * (law[1] - 1.0)) * share
    return rotation / torque


@compiled_ieee
def evaluate(
    link_length: Floats, leg_width: Floats, offset: Floats, poses: Floats, torque: float, law: Floats
) -> tuple[Floats, Floats]:
    """Return workspace means of the conditioning index and of T_c [rad/(N m)], (n,) each; NaN where out of reach.

    Designs are L, w and R (n,) [m], `poses` horizontal positions (m, 2) [m], `torque` the moment [N m] at which T_c is
    taken and `law` the link law (a factor, b, floor^2).
    """
    index, compliance = np.empty(len(link_length)), np.empty(len(link_length))
    ex, ey = np.empty(3), np.empty(3)
    for k in range(3):
        ex[k], ey[k] = math.cos(2.0 * math.pi * k / 3.0), math.sin(2.0 * math.pi * k / 3.0)
    ux, uy, uz, moments = np.empty(3), np.empty(3), np.empty(3), np.empty((3, 3))
    for i in range(len(link_length)):
        scale = leg_width[i] / link_length[i]
        total_index, total_compliance = 0.0, 0.0
        for j in range(len(poses)):
            for k in range(3):
                ux[k], uy[k] = poses[j, 0] - offset[i] * ex[k], poses[j, 1] - offset[i] * ey[k]
                uz[k] = math.sqrt(link_length[i] ** 2 - ux[k] * ux[k] - uy[k] * uy[k])
                moments[k, 0], moments[k, 1] = scale * ex[k] * uz[k], scale * ey[k] * uz[k]
                moments[k, 2] = -scale * (ey[k] * uy[k] + ex[k] * ux[k])
            total_index += conditioning(ux, uy, uz)
            total_compliance += torsion(moments, torque, law)
        index[i], compliance[i] = total_index / len(poses), total_compliance / len(poses)
    return index, compliance
