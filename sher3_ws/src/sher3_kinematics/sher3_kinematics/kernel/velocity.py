"""Compiled inverse velocity and its limits: scaled along the commanded direction, braking before every end."""

from __future__ import annotations

import math

import numpy as np
from sher3_common.compiled import compiled_ieee

from sher3_kinematics.kernel.delta import leg_vectors, rail_up
from sher3_kinematics.kernel.parameters import KernelParameters
from sher3_kinematics.kernel.robot import arm_vector, base_is_rotated, base_rotate
from sher3_kinematics.kernel.tilt import tilt_sine_cosine, tilt_slope

Array = np.ndarray

FREE, NOT_FINITE, ACCELERATION = 0, 1, 2
VELOCITY, TRAVEL, REACH = 10, 20, 30
"""Codes of what limits a velocity: FREE is nothing; VELOCITY + k and TRAVEL + k are actuator k, REACH + k is leg k,
counted from 0."""


@compiled_ieee
def twist_inverse_into(p: KernelParameters, q: Array, twist: Array, q_dot: Array) -> None:
    """Write the actuator velocities (5,) for a tip twist (6,) in {b} (linear; angular).

    The robot has two rotations, about x of {b} and about y of {r}. The angular velocity is projected orthogonally onto
    these two axes, and its third component is dropped; so a velocity proportional to a torque never opposes that
    torque. The linear velocity of the tip is exact. NaN where the configuration does not exist, infinite at a
    singularity.
    """
    vx, vy, vz, wx, wy, wz = twist[0], twist[1], twist[2], twist[3], twist[4], twist[5]
    if base_is_rotated(p):
        vx, vy, vz = base_rotate(p, vx, vy, vz, -1.0)
        wx, wy, wz = base_rotate(p, wx, wy, wz, -1.0)
    _, n1, n2, n3 = leg_vectors(p, q[0], q[1], q[2])
    roll = q[3] + p.zero_4
    sa, ca = math.sin(roll), math.cos(roll)
    st, ct = tilt_sine_cosine(p, q[4])
    arm, tilt = arm_vector(p, sa, ca, st, ct)
    tilt_rate = ca * wy + sa * wz
    ux = vx - tilt_rate * (ca * tilt[2] - sa * tilt[1])
    uy = vy + wx * arm[2] - tilt_rate * sa * tilt[0]
    uz = vz - wx * arm[1] + tilt_rate * ca * tilt[0]
    drive_1 = n1[0] * p.rail_1x + n1[1] * p.rail_1y + n1[2] * rail_up(p.rail_1x, p.rail_1y)
    drive_2 = n2[0] * p.rail_2x + n2[1] * p.rail_2y + n2[2] * rail_up(p.rail_2x, p.rail_2y)
    drive_3 = n3[0] * p.rail_3x + n3[1] * p.rail_3y + n3[2] * rail_up(p.rail_3x, p.rail_3y)
    q_dot[0] = (n1[0] * ux + n1[1] * uy + n1[2] * uz) / drive_1
    q_dot[1] = (n2[0] * ux + n2[1] * uy + n2[2] * uz) / drive_2
    q_dot[2] = (n3[0] * ux + n3[1] * uy + n3[2] * uz) / drive_3
    q_dot[3] = wx
    q_dot[4] = tilt_rate * tilt_slope(p, st, ct)


@compiled_ieee
def time_to_reach_end(p: KernelParameters, q: Array, q_dot: Array, elevation: float) -> tuple[float, int]:
    """Return the time [s] until a leg is down to the least elevation at constant velocity, and the leg.

    The horizontal distance rho_k of the ball pairs of leg k, across its rail, ends at L sqrt(1 - elevation^2).
    """
    _, n1, n2, n3 = leg_vectors(p, q[0], q[1], q[2])
    legs = (n1, n2, n3)
    drives = np.empty(3)
    for k in range(3):
        rx, ry = p[6 * k + 4], p[6 * k + 5]
        drives[k] = legs[k][0] * rx + legs[k][1] * ry + legs[k][2] * rail_up(rx, ry)
    volume = n1[0] * (n2[1] * n3[2] - n2[2] * n3[1])
    volume += n1[1] * (n2[2] * n3[0] - n2[0] * n3[2]) + n1[2] * (n2[0] * n3[1] - n2[1] * n3[0])
    px, py, pz = 0.0, 0.0, 0.0
    for k in range(3):
        a, b = legs[(k + 1) % 3], legs[(k + 2) % 3]
        rate = drives[k] * q_dot[k] / volume
        px += (a[1] * b[2] - a[2] * b[1]) * rate
        py += (a[2] * b[0] - a[0] * b[2]) * rate
        pz += (a[0] * b[1] - a[1] * b[0]) * rate
    if not math.isfinite(px + py + pz):
        return 0.0, 0
    nearest, which = math.inf, 0
    for k in range(3):
        rx, ry = p[6 * k + 4], p[6 * k + 5]
        rz = rail_up(rx, ry)
        ox, oy, oz = legs[k][0] - drives[k] * rx, legs[k][1] - drives[k] * ry, legs[k][2] - drives[k] * rz
        across = math.sqrt(ox * ox + oy * oy + oz * oz)
        outward = (ox * px + oy * py + oz * pz) / across if across > 0.0 else 0.0
        if outward > 0.0:
            time = (p[6 * k] * math.sqrt(1.0 - elevation * elevation) - across) / outward
            if time < nearest:
                nearest, which = time, k
    return nearest, which


@compiled_ieee
def stopping_speed(room: float, acceleration: float, period: float) -> float:
    """Return the largest speed v that, held for one period, still allows a stop at `acceleration` within `room`.

    v period + v^2 / (2 a) = room: the braking distance in the discrete form of Flacco, De Luca, Khatib, "Motion control
    of redundant robots under joint constraints: Saturation in the Null Space", ICRA 2012, eq. (5), and one period more.
    """
    if not room > 0.0:
        return 0.0
    return 2.0 * room / (period + math.sqrt(period * period + 2.0 * room / acceleration))


@compiled_ieee
def braking_scale(
    p: KernelParameters, q: Array, q_dot: Array, limits: Array, elevation: float, period: float
) -> tuple[float, int]:
    """Return the largest scale of a velocity from which the robot still stops before every end, and the end's code.

    Along the commanded direction all actuators brake together, at min a_k / |q_dot_k|, so the rule for one actuator
    applies to the scale, with the time to the nearest end at full velocity as its room.
    """
    ahead, leg = time_to_reach_end(p, q, q_dot, elevation)
    code = REACH + leg
    alpha = math.inf
    for k in range(5):
        speed = abs(q_dot[k])
        if speed > 0.0:
            alpha = min(alpha, limits[3, k] / speed)
            end = limits[1, k] if q_dot[k] > 0.0 else limits[0, k]
            time = (end - q[k]) / q_dot[k]
            if time < ahead:
                ahead, code = time, TRAVEL + k
    if alpha == math.inf:
        return math.inf, FREE
    return stopping_speed(ahead, alpha, period), code


@compiled_ieee
def limit_velocity_into(
    p: KernelParameters,
    q: Array,
    wanted: Array,
    previous: Array,
    limits: Array,
    elevation: float,
    period: float,
    reaction: float,
    q_dot: Array,
) -> tuple[float, int]:
    """Write the permitted actuator velocity (5,); return its scale along `wanted` and the code of what limits it.

    1. `wanted` is scaled as a whole until velocity limits and braking rule permit it.
    2. The step from `previous` is shortened as a whole until the acceleration limits permit it.
    3. An actuator that could not stop before its own end is held to its own braking bound, whatever the direction.

    A value that is not finite gives zero at once. The rule is applied to the position at which this command will act:
    one `reaction` after the reading of q, with `previous` executed until then. The rows of `limits` (4, 5) are lower,
    upper, velocity, acceleration.
    """
    ahead = np.empty(5)
    scale, code = 1.0, FREE
    for k in range(5):
        if not (math.isfinite(wanted[k]) and math.isfinite(q[k]) and math.isfinite(previous[k])):
            q_dot[:] = 0.0
            return 0.0, NOT_FINITE
        ahead[k] = q[k] + previous[k] * (reaction - period)
        if abs(wanted[k]) * scale > limits[2, k]:
            scale, code = limits[2, k] / abs(wanted[k]), VELOCITY + k
    brake, end = braking_scale(p, ahead, wanted, limits, elevation, period)
    if brake < scale:
        scale, code = brake, end
    fraction = 1.0
    for k in range(5):
        step = abs(scale * wanted[k] - previous[k])
        if step * fraction > limits[3, k] * period:
            fraction = limits[3, k] * period / step
    if fraction < 1.0 and code == FREE:
        code = ACCELERATION
    for k in range(5):
        value = previous[k] + fraction * (scale * wanted[k] - previous[k])
        above = stopping_speed(limits[1, k] - ahead[k], limits[3, k], period)
        below = stopping_speed(ahead[k] - limits[0, k], limits[3, k], period)
        q_dot[k] = min(max(value, -below), above)
    return scale, code
