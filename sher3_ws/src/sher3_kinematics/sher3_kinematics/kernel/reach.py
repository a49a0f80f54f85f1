"""Compiled margins of a configuration: distances to singularity and to the edge of the delta workspace."""

from __future__ import annotations

import math

import numpy as np
from sher3_common.compiled import compiled_ieee

from sher3_kinematics.kernel.delta import leg_vectors, rail_up, stage_inverse
from sher3_kinematics.kernel.parameters import KernelParameters
from sher3_kinematics.kernel.robot import base_is_rotated, base_rotate
from sher3_kinematics.kernel.tilt import tilt_sine_cosine

Array = np.ndarray


@compiled_ieee
def singularity_margins_into(p: KernelParameters, q: Array, margins: Array) -> None:
    """Write five dimensionless distances to singularity (5,), all 0 at one and at most 1.

    margins[0:3]: sine of each leg's elevation over the plane across its rail (0: the slider cannot move the platform);
    margins[3]: |n1 . (n2 x n3)| of the unit leg vectors (0: the platform yields with the sliders held);
    margins[4]: sine of the angle between crank and coupler (0: dead point of the tilt linkage).
    """
    _, n1, n2, n3 = leg_vectors(p, q[0], q[1], q[2])
    margins[0] = (n1[0] * p.rail_1x + n1[1] * p.rail_1y + n1[2] * rail_up(p.rail_1x, p.rail_1y)) / p.link_1
    margins[1] = (n2[0] * p.rail_2x + n2[1] * p.rail_2y + n2[2] * rail_up(p.rail_2x, p.rail_2y)) / p.link_2
    margins[2] = (n3[0] * p.rail_3x + n3[1] * p.rail_3y + n3[2] * rail_up(p.rail_3x, p.rail_3y)) / p.link_3
    volume = (
        n1[0] * (n2[1] * n3[2] - n2[2] * n3[1])
        + n1[1] * (n2[2] * n3[0] - n2[0] * n3[2])
        + n1[2] * (n2[0] * n3[1] - n2[1] * n3[0])
    )
    margins[3] = abs(volume) / (p.link_1 * p.link_2 * p.link_3)
    sine, cosine = tilt_sine_cosine(p, q[4])
    reach = p.offset - p.crank * cosine
    rise = math.sqrt(p.coupler * p.coupler - reach * reach)
    margins[4] = (cosine * rise - sine * reach) / p.coupler


@compiled_ieee
def leg_edge_distance(link: float, dx: float, dy: float, dz: float, low: float, high: float, flat: float) -> float:
    """Return the signed distance [m] of the platform to the boundary of what one leg allows.

    (dx, dy, dz) is the platform seen from the leg's anchor with the rail along z. The boundary consists of the upper
    half-spheres about the slider's end positions `low` and `high` and of the cylinder of radius `flat` about the rail.
    Inside the result is exact; outside it is the negative of a lower bound of the distance.
    """
    across = math.sqrt(dx * dx + dy * dy)
    side = flat - across
    above = dz - high
    if above >= 0.0:
        top = link - math.sqrt(across * across + above * above)
    else:
        top = math.sqrt((link - across) ** 2 + above * above)
    over = dz - low
    bottom = math.sqrt(across * across + over * over) - link
    if over < 0.0:
        bottom = -math.sqrt((link - across) ** 2 + over * over)
    return min(side, top, bottom)


@compiled_ieee
def delta_edge_distances_into(
    p: KernelParameters, x: float, y: float, z: float, lower: Array, upper: Array, elevation: float, distances: Array
) -> None:
    """Write the signed distance (3,) [m] of a platform centre in {b} to the end of each leg's reach.

    `lower` and `upper` hold the slider travel [m] in their first three entries; `elevation` is the least sine of the
    leg elevation that still counts as workspace. See `leg_edge_distance` for the sign and exactness.
    """
    if base_is_rotated(p):
        x, y, z = base_rotate(p, x, y, z, -1.0)
    for k in range(3):
        link, ax, ay, az, rx, ry = p[6 * k], p[6 * k + 1], p[6 * k + 2], p[6 * k + 3], p[6 * k + 4], p[6 * k + 5]
        rz = rail_up(rx, ry)
        dx, dy, dz = x - ax, y - ay, z - az
        along = dx * rx + dy * ry + dz * rz
        ox, oy, oz = dx - along * rx, dy - along * ry, dz - along * rz
        across = math.sqrt(ox * ox + oy * oy + oz * oz)
        flat = link * math.sqrt(1.0 - elevation * elevation)
        zero = p[18 + k]
        distances[k] = leg_edge_distance(link, across, 0.0, along, lower[k] + zero, upper[k] + zero, flat)


@compiled_ieee
def leg_directions_into(p: KernelParameters, x: float, y: float, z: float, directions: Array) -> None:
    """Write the unit leg vectors (3, 3), one row per leg, for a platform centre in {b}; NaN out of reach."""
    if base_is_rotated(p):
        x, y, z = base_rotate(p, x, y, z, -1.0)
    q1, q2, q3 = stage_inverse(p, x, y, z)
    _, n1, n2, n3 = leg_vectors(p, q1, q2, q3)
    for i in range(3):
        directions[0, i], directions[1, i], directions[2, i] = n1[i] / p.link_1, n2[i] / p.link_2, n3[i] / p.link_3
