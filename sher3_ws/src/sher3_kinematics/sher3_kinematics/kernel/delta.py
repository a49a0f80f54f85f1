"""Compiled kinematics of the linear delta stage, three sliders on rails that need be neither parallel nor equal.

A leg is a parallelogram, so the platform only translates: the platform centre P lies on three spheres of radius
`link_k` about c_k = anchor_k + s_k u_k, with u_k the rail direction and s_k = q_k + zero_k the slider height.
Where no solution exists the functions return NaN.
"""

from __future__ import annotations

import math

from sher3_common.compiled import compiled_ieee

from sher3_kinematics.kernel.parameters import KernelParameters

Triple = tuple[float, float, float]


@compiled_ieee
def rail_up(x: float, y: float) -> float:
    """Return the vertical component of a unit rail direction with horizontal components x and y."""
    return math.sqrt(1.0 - x * x - y * y)


@compiled_ieee
def sphere_centres(p: KernelParameters, q1: float, q2: float, q3: float) -> tuple[Triple, Triple, Triple]:
    """Return the centres [m] of the three spheres on which the platform centre lies, in the mechanism's base."""
    s1, s2, s3 = q1 + p.zero_1, q2 + p.zero_2, q3 + p.zero_3
    return (
        (
            p.anchor_1x + s1 * p.rail_1x,
            p.anchor_1y + s1 * p.rail_1y,
            p.anchor_1z + s1 * rail_up(p.rail_1x, p.rail_1y),
        ),
        (
            p.anchor_2x + s2 * p.rail_2x,
            p.anchor_2y + s2 * p.rail_2y,
            p.anchor_2z + s2 * rail_up(p.rail_2x, p.rail_2y),
        ),
        (
            p.anchor_3x + s3 * p.rail_3x,
            p.anchor_3y + s3 * p.rail_3y,
            p.anchor_3z + s3 * rail_up(p.rail_3x, p.rail_3y),
        ),
    )


@compiled_ieee
def upper_intersection(c1: Triple, c2: Triple, c3: Triple, r1: float, r2: float, r3: float) -> Triple:
    """Return the upper common point of three spheres (trilateration in the plane of their centres)."""
    ax, ay, az = c2[0] - c1[0], c2[1] - c1[1], c2[2] - c1[2]
    bx, by, bz = c3[0] - c1[0], c3[1] - c1[1], c3[2] - c1[2]
    length = math.sqrt(ax * ax + ay * ay + az * az)
    ex, ey, ez = ax / length, ay / length, az / length
    along = ex * bx + ey * by + ez * bz
    fx, fy, fz = bx - along * ex, by - along * ey, bz - along * ez
    across = math.sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz = fx / across, fy / across, fz / across
    gx, gy, gz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    u = (r1 * r1 - r2 * r2 + length * length) / (2.0 * length)
    v = (r1 * r1 - r3 * r3 + along * along + across * across - 2.0 * along * u) / (2.0 * across)
    w = math.copysign(math.sqrt(r1 * r1 - u * u - v * v), gz)
    return (
        c1[0] + u * ex + v * fx + w * gx,
        c1[1] + u * ey + v * fy + w * gy,
        c1[2] + u * ez + v * fz + w * gz,
    )


@compiled_ieee
def leg_inverse(link: float, ax: float, ay: float, az: float, rx: float, ry: float, x: float, y: float, z: float):
    """Return the slider height [m] of one leg for the platform centre (x, y, z), slider below the platform."""
    rz = rail_up(rx, ry)
    dx, dy, dz = x - ax, y - ay, z - az
    along = dx * rx + dy * ry + dz * rz
    ox, oy, oz = dx - along * rx, dy - along * ry, dz - along * rz
    return along - math.sqrt(link * link - (ox * ox + oy * oy + oz * oz))


@compiled_ieee
def stage_forward(p: KernelParameters, q1: float, q2: float, q3: float) -> Triple:
    """Return the platform centre [m] in the mechanism's base, before the base rotation."""
    c1, c2, c3 = sphere_centres(p, q1, q2, q3)
    return upper_intersection(c1, c2, c3, p.link_1, p.link_2, p.link_3)


@compiled_ieee
def stage_inverse(p: KernelParameters, x: float, y: float, z: float) -> Triple:
    """Return the slider positions [m] for a platform centre in the mechanism's base."""
    return (
        leg_inverse(p.link_1, p.anchor_1x, p.anchor_1y, p.anchor_1z, p.rail_1x, p.rail_1y, x, y, z) - p.zero_1,
        leg_inverse(p.link_2, p.anchor_2x, p.anchor_2y, p.anchor_2z, p.rail_2x, p.rail_2y, x, y, z) - p.zero_2,
        leg_inverse(p.link_3, p.anchor_3x, p.anchor_3y, p.anchor_3z, p.rail_3x, p.rail_3y, x, y, z) - p.zero_3,
    )


@compiled_ieee(forceinline=True)
def leg_vectors(p: KernelParameters, q1: float, q2: float, q3: float) -> tuple[Triple, Triple, Triple, Triple]:
    """Return the platform centre and the three leg vectors from slider to platform [m], in the mechanism's base."""
    c1, c2, c3 = sphere_centres(p, q1, q2, q3)
    centre = upper_intersection(c1, c2, c3, p.link_1, p.link_2, p.link_3)
    x, y, z = centre
    return (
        centre,
        (x - c1[0], y - c1[1], z - c1[2]),
        (x - c2[0], y - c2[1], z - c2[2]),
        (x - c3[0], y - c3[1], z - c3[2]),
    )


@compiled_ieee
def _cross(a: Triple, b: Triple) -> Triple:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@compiled_ieee
def _scale(v: Triple, factor: float) -> Triple:
    return (v[0] * factor, v[1] * factor, v[2] * factor)


@compiled_ieee(forceinline=True)
def stage_columns(p: KernelParameters, n1: Triple, n2: Triple, n3: Triple) -> tuple[Triple, Triple, Triple]:
    """Return the three columns of the stage Jacobian, platform velocity per slider velocity, from the leg vectors.

    A rigid link keeps n_k . (Pdot - u_k qdot_k) = 0, so the columns are those of N^-1 diag(n_k . u_k).
    """
    c23, c31, c12 = _cross(n2, n3), _cross(n3, n1), _cross(n1, n2)
    volume = n1[0] * c23[0] + n1[1] * c23[1] + n1[2] * c23[2]
    drive_1 = n1[0] * p.rail_1x + n1[1] * p.rail_1y + n1[2] * rail_up(p.rail_1x, p.rail_1y)
    drive_2 = n2[0] * p.rail_2x + n2[1] * p.rail_2y + n2[2] * rail_up(p.rail_2x, p.rail_2y)
    drive_3 = n3[0] * p.rail_3x + n3[1] * p.rail_3y + n3[2] * rail_up(p.rail_3x, p.rail_3y)
    return _scale(c23, drive_1 / volume), _scale(c31, drive_2 / volume), _scale(c12, drive_3 / volume)
