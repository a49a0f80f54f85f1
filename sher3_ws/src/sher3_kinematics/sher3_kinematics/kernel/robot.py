"""Compiled kinematics of the whole robot: tip pose, tip Jacobian, gravity load and closed-form pose inverse.

T_bt = B Trans(P) Trans(z, d1) Rot(x, roll) Trans(x, d2) Trans(z, d3) Rot(y, tilt) Trans(tool), recorded-run contract,
section 2; B is the base rotation, identity on the nominal robot. Outputs are written into arrays of the caller.
"""

from __future__ import annotations

import math

import numpy as np
from sher3_common.compiled import compiled_ieee
from sher3_description.contract import GRAVITY

from sher3_kinematics.kernel.delta import Triple, leg_vectors, stage_columns, stage_forward, stage_inverse
from sher3_kinematics.kernel.parameters import KernelParameters
from sher3_kinematics.kernel.tilt import tilt_sine_cosine, tilt_slider, tilt_slope

Array = np.ndarray


@compiled_ieee
def base_is_rotated(p: KernelParameters) -> bool:
    """Return whether the base rotation is not the identity."""
    return p.base_x != 0.0 or p.base_y != 0.0 or p.base_z != 0.0


@compiled_ieee
def base_rotate(p: KernelParameters, x: float, y: float, z: float, sign: float) -> Triple:
    """Rotate a vector by the base rotation vector (sign 1) or its inverse (sign -1), after Rodrigues."""
    bx, by, bz = sign * p.base_x, sign * p.base_y, sign * p.base_z
    angle = math.sqrt(bx * bx + by * by + bz * bz)
    if angle == 0.0:
        return x, y, z
    a = math.sin(angle) / angle
    half = math.sin(0.5 * angle) / angle
    b = 2.0 * half * half
    cx, cy, cz = by * z - bz * y, bz * x - bx * z, bx * y - by * x
    dx, dy, dz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
    return x + a * cx + b * dx, y + a * cy + b * dy, z + a * cz + b * dz


@compiled_ieee
def delta_forward(p: KernelParameters, q1: float, q2: float, q3: float) -> Triple:
    """Return the platform centre [m] in {b} for the slider positions [m]; NaN where the legs do not meet."""
    x, y, z = stage_forward(p, q1, q2, q3)
    return base_rotate(p, x, y, z, 1.0) if base_is_rotated(p) else (x, y, z)


@compiled_ieee
def delta_inverse(p: KernelParameters, x: float, y: float, z: float) -> Triple:
    """Return the slider positions [m] for a platform centre [m] in {b}; NaN where a leg does not reach."""
    if base_is_rotated(p):
        x, y, z = base_rotate(p, x, y, z, -1.0)
    return stage_inverse(p, x, y, z)


@compiled_ieee
def delta_jacobian_into(p: KernelParameters, q1: float, q2: float, q3: float, jacobian: Array) -> None:
    """Write d platform centre / d slider positions, (3, 3), in {b}."""
    _, n1, n2, n3 = leg_vectors(p, q1, q2, q3)
    columns = stage_columns(p, n1, n2, n3)
    for k in range(3):
        v = columns[k]
        if base_is_rotated(p):
            v = base_rotate(p, v[0], v[1], v[2], 1.0)
        jacobian[0, k], jacobian[1, k], jacobian[2, k] = v


@compiled_ieee
def delta_jacobian(p: KernelParameters, q1: float, q2: float, q3: float) -> Array:
    """Return d platform centre / d slider positions, (3, 3), in {b}."""
    jacobian = np.empty((3, 3))
    delta_jacobian_into(p, q1, q2, q3, jacobian)
    return jacobian


@compiled_ieee
def arm_vector(p: KernelParameters, sa: float, ca: float, st: float, ct: float) -> tuple[Triple, Triple]:
    """Return the vectors roll axis origin -> tip and tilt axis -> tip [m] for sine and cosine of roll and tilt."""
    u = ct * p.tool_x + st * p.tool_z
    w = ct * p.tool_z - st * p.tool_x
    tilt = (u, ca * p.tool_y - sa * w, sa * p.tool_y + ca * w)
    return (tilt[0] + p.d2, tilt[1] - sa * p.d3, tilt[2] + ca * p.d3), tilt


@compiled_ieee
def tip_position(p: KernelParameters, q: Array) -> Triple:
    """Return the tip position [m] in {b} for the actuator positions q (5,)."""
    x, y, z = stage_forward(p, q[0], q[1], q[2])
    roll = q[3] + p.zero_4
    st, ct = tilt_sine_cosine(p, q[4])
    arm, _ = arm_vector(p, math.sin(roll), math.cos(roll), st, ct)
    x, y, z = x + arm[0], y + arm[1], z + p.d1 + arm[2]
    return base_rotate(p, x, y, z, 1.0) if base_is_rotated(p) else (x, y, z)


@compiled_ieee
def tip_pose_into(p: KernelParameters, q: Array, rotation: Array, position: Array) -> None:
    """Write the tip's rotation (3, 3) and position (3,) [m] in {b} for the actuator positions q (5,)."""
    x, y, z = stage_forward(p, q[0], q[1], q[2])
    roll = q[3] + p.zero_4
    sa, ca = math.sin(roll), math.cos(roll)
    st, ct = tilt_sine_cosine(p, q[4])
    arm, _ = arm_vector(p, sa, ca, st, ct)
    position[0], position[1], position[2] = x + arm[0], y + arm[1], z + p.d1 + arm[2]
    rotation[0, 0], rotation[0, 1], rotation[0, 2] = ct, 0.0, st
    rotation[1, 0], rotation[1, 1], rotation[1, 2] = sa * st, ca, -sa * ct
    rotation[2, 0], rotation[2, 1], rotation[2, 2] = -ca * st, sa, ca * ct
    if base_is_rotated(p):
        position[0], position[1], position[2] = base_rotate(p, position[0], position[1], position[2], 1.0)
        for k in range(3):
            v = base_rotate(p, rotation[0, k], rotation[1, k], rotation[2, k], 1.0)
            rotation[0, k], rotation[1, k], rotation[2, k] = v


@compiled_ieee
def tip_pose(p: KernelParameters, q: Array) -> tuple[Array, Array]:
    """Return the tip's rotation (3, 3) and position (3,) [m] in {b} for the actuator positions q (5,)."""
    rotation, position = np.empty((3, 3)), np.empty(3)
    tip_pose_into(p, q, rotation, position)
    return rotation, position


@compiled_ieee
def tip_jacobian_into(p: KernelParameters, q: Array, jacobian: Array) -> None:
    """Write the (6, 5) Jacobian from actuator velocities to the tip twist (linear; angular) in {b} at the tip.

    [J_delta | x cross (p - p_r) | (Rx y) cross (p - p_a) / ratio ; 0 | x | (Rx y) / ratio], ratio = d slider / d angle.
    """
    _, n1, n2, n3 = leg_vectors(p, q[0], q[1], q[2])
    columns = stage_columns(p, n1, n2, n3)
    for k in range(3):
        v = columns[k]
        jacobian[0, k], jacobian[1, k], jacobian[2, k] = v
        jacobian[3, k], jacobian[4, k], jacobian[5, k] = 0.0, 0.0, 0.0
    roll = q[3] + p.zero_4
    sa, ca = math.sin(roll), math.cos(roll)
    st, ct = tilt_sine_cosine(p, q[4])
    arm, tilt = arm_vector(p, sa, ca, st, ct)
    rate = 1.0 / tilt_slope(p, st, ct)
    jacobian[0, 3], jacobian[1, 3], jacobian[2, 3] = 0.0, -arm[2], arm[1]
    jacobian[3, 3], jacobian[4, 3], jacobian[5, 3] = 1.0, 0.0, 0.0
    jacobian[0, 4] = (ca * tilt[2] - sa * tilt[1]) * rate
    jacobian[1, 4], jacobian[2, 4] = sa * tilt[0] * rate, -ca * tilt[0] * rate
    jacobian[3, 4], jacobian[4, 4], jacobian[5, 4] = 0.0, ca * rate, sa * rate
    if base_is_rotated(p):
        for k in range(5):
            v = base_rotate(p, jacobian[0, k], jacobian[1, k], jacobian[2, k], 1.0)
            jacobian[0, k], jacobian[1, k], jacobian[2, k] = v
            v = base_rotate(p, jacobian[3, k], jacobian[4, k], jacobian[5, k], 1.0)
            jacobian[3, k], jacobian[4, k], jacobian[5, k] = v


@compiled_ieee
def tip_jacobian(p: KernelParameters, q: Array) -> Array:
    """Return the (6, 5) Jacobian from actuator velocities to the tip twist (linear; angular) in {b} at the tip."""
    jacobian = np.empty((6, 5))
    tip_jacobian_into(p, q, jacobian)
    return jacobian


@compiled_ieee
def gravity_load_into(p: KernelParameters, q: Array, load: Array) -> None:
    """Write G(q) (5,) [N, N m], the effort that holds the robot against gravity, recorded-run contract, section 3.

    Sliders carry `moving_mass` alone; roll and tilt carry the gradient of the potential of `roll_mass` and `tilt_mass`.
    Gravity acts along -z of the mechanism's base, whatever its rotation.
    """
    _, n1, n2, n3 = leg_vectors(p, q[0], q[1], q[2])
    c1, c2, c3 = stage_columns(p, n1, n2, n3)
    weight = p.moving_mass * GRAVITY
    load[0], load[1], load[2] = c1[2] * weight, c2[2] * weight, c3[2] * weight
    roll = q[3] + p.zero_4
    sa, ca = math.sin(roll), math.cos(roll)
    st, ct = tilt_sine_cosine(p, q[4])
    height = p.d3 - st * p.tilt_x + ct * p.tilt_z
    load[3] = GRAVITY * (p.roll_mass * (ca * p.roll_y - sa * p.roll_z) + p.tilt_mass * (ca * p.tilt_y - sa * height))
    load[4] = -GRAVITY * p.tilt_mass * ca * (ct * p.tilt_x + st * p.tilt_z) / tilt_slope(p, st, ct)


@compiled_ieee
def gravity_load(p: KernelParameters, q: Array) -> Array:
    """Return G(q) (5,) [N, N m]; see `gravity_load_into`."""
    load = np.empty(5)
    gravity_load_into(p, q, load)
    return load


@compiled_ieee
def pose_inverse_into(p: KernelParameters, x: float, y: float, z: float, axis: Array, q: Array) -> None:
    """Write the actuator positions q (5,) for a tip position [m] and a distal tool axis (3,) in {b}; NaN out of reach.

    The axis need not have unit length. Of the two roll-tilt pairs the one with the tilt within 90 degrees is taken:
    axis = (-sin tilt, sin roll cos tilt, -cos roll cos tilt).
    """
    ax, ay, az = axis[0], axis[1], axis[2]
    if base_is_rotated(p):
        x, y, z = base_rotate(p, x, y, z, -1.0)
        ax, ay, az = base_rotate(p, ax, ay, az, -1.0)
    level = math.sqrt(ay * ay + az * az)
    length = math.sqrt(ax * ax + level * level)
    st, ct = -ax / length, level / length
    sa, ca = ay / level, -az / level
    arm, _ = arm_vector(p, sa, ca, st, ct)
    q[0], q[1], q[2] = stage_inverse(p, x - arm[0], y - arm[1], z - p.d1 - arm[2])
    q[3] = math.atan2(sa, ca) - p.zero_4
    q[4] = tilt_slider(p, math.atan2(st, ct))


@compiled_ieee
def pose_inverse(p: KernelParameters, position: Array, axis: Array) -> Array:
    """Return the actuator positions (5,) for a tip position (3,) [m] and tool axis (3,); see `pose_inverse_into`."""
    q = np.empty(5)
    pose_inverse_into(p, position[0], position[1], position[2], axis, q)
    return q
