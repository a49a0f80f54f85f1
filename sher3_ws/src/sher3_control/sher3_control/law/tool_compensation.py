"""From the raw wrench in {f} to the contact wrench at the tip: less the tool's weight and the bias, moved to {t}.

The sensor reads the contact wrench moved to {f}, plus the weight of `tool_mass` at `tool_com`. The wrench acts ON the
tool (recorded-run contract, section 3).
"""

import math

from sher3_common.compiled import compiled
from sher3_common.vectors import Rotation, Twist, Vector3, Wrench
from sher3_description.contract import GRAVITY


@compiled
def tip_rotation(roll: float, tilt: float) -> Rotation:
    """Return the rotation of {t}, and of {f}, in {b}: Rx(roll) Ry(tilt), angles in rad (contract section 2)."""
    cr, sr, ct, st = math.cos(roll), math.sin(roll), math.cos(tilt), math.sin(tilt)
    return (ct, 0.0, st, sr * st, cr, -sr * ct, -cr * st, sr, cr * ct)


@compiled
def cross(a: Vector3, b: Vector3) -> Vector3:
    """Return the cross product a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@compiled
def tool_gravity(rotation: Rotation, mass: float, com: Vector3) -> Wrench:
    """Return the wrench of the tool's weight in {f} (N, N m): `mass` [kg] at `com` [m] in {f}."""
    weight = -mass * GRAVITY
    force = (rotation[6] * weight, rotation[7] * weight, rotation[8] * weight)
    torque = cross(com, force)
    return (force[0], force[1], force[2], torque[0], torque[1], torque[2])


@compiled
def contact_wrench(raw: Wrench, rotation: Rotation, mass: float, com: Vector3, bias: Wrench) -> Wrench:
    """Return the raw wrench in {f} less the tool's weight and the bias (N, N m)."""
    g = tool_gravity(rotation, mass, com)
    return (
        raw[0] - g[0] - bias[0],
        raw[1] - g[1] - bias[1],
        raw[2] - g[2] - bias[2],
        raw[3] - g[3] - bias[3],
        raw[4] - g[4] - bias[4],
        raw[5] - g[5] - bias[5],
    )


@compiled
def wrench_at_tip(wrench: Wrench, position: Vector3) -> Wrench:
    """Return at the tip a wrench that is given in {f}.

    The origin of {f} lies at `position` [m] in {t}; the axes of the two frames are parallel.
    """
    moment = cross(position, (wrench[0], wrench[1], wrench[2]))
    return (wrench[0], wrench[1], wrench[2], wrench[3] + moment[0], wrench[4] + moment[1], wrench[5] + moment[2])


@compiled
def _rotate(r: Rotation, x: float, y: float, z: float) -> Vector3:
    """Return the vector (x, y, z) turned by a rotation."""
    return (r[0] * x + r[1] * y + r[2] * z, r[3] * x + r[4] * y + r[5] * z, r[6] * x + r[7] * y + r[8] * z)


@compiled
def twist_in_base(twist: Twist, rotation: Rotation) -> Twist:
    """Return in {b} a twist of the tip that is given in {t}; the reference point stays the tip."""
    v = _rotate(rotation, twist[0], twist[1], twist[2])
    w = _rotate(rotation, twist[3], twist[4], twist[5])
    return (v[0], v[1], v[2], w[0], w[1], w[2])
