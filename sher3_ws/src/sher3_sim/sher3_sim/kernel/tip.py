"""From load positions to the true tip pose: mechanism errors and elastic structure (compiled)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from sher3_common.compiled import compiled
from sher3_description.contract import REFERENCE_TEMPERATURE
from sher3_kinematics.kernel import KernelParameters, tip_pose_into
from sher3_kinematics.kernel.delta import leg_vectors
from sher3_kinematics.tip_deflection import ArmCompliance

from sher3_sim.found import TIP, add_body
from sher3_sim.kernel.quantities import look_at_tip

Array = np.ndarray
_ARM = ArmCompliance()
YAW_STIFFNESS, PITCH_STIFFNESS, AXIAL_COMPLIANCE = _ARM.yaw, _ARM.pitch, _ARM.along_x
"""Lumped structure behind the delta stage [N m/rad, N m/rad, m/N] that reproduces the paper's deflection table."""
CONTACT_FORCE = 0.1
"""Load [N] at which a ball joint rests on one side of its clearance; below it the change of side is smoothed."""
LINK_FORCE = 0.5
"""Force [N] below which the link law a |F|^b, whose slope is infinite at zero, is made linear."""


@compiled
def cross(a: Array, b: Array) -> Array:
    """Return a x b."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


@compiled
def add_clearance(p: KernelParameters, axis: Any, q: Array, load: Array, jacobian: Array, twist: Array) -> None:
    """Add to the platform's twist the shift from clearance in the ball joints.

    A leg is longer by half its clearance in tension and shorter by as much in compression. A slider that carries `load`
    pushes its leg, which leans, with load L / n_z; n_k . dP = L dL_k, and the columns of the stage Jacobian give the
    shift per leg.
    """
    _, n1, n2, n3 = leg_vectors(p, q[0], q[1], q[2])
    slant = (p.link_1 / n1[2], p.link_2 / n2[2], p.link_3 / n3[2])
    for k in range(3):
        longer = -0.5 * axis[k].clearance * math.tanh(load[k] * slant[k] / CONTACT_FORCE)
        for i in range(3):
            twist[i] += jacobian[i, k] * slant[k] * longer


@compiled
def add_growth(p: KernelParameters, growth: float, q: Array, jacobian: Array, shift: Array) -> None:
    """Add the platform's shift [m] when all links are longer by the share `growth`; the legs keep their slant."""
    _, n1, n2, n3 = leg_vectors(p, q[0], q[1], q[2])
    longer = (p.link_1 * p.link_1 / n1[2], p.link_2 * p.link_2 / n2[2], p.link_3 * p.link_3 / n3[2])
    for i in range(3):
        for k in range(3):
            shift[i] += jacobian[i, k] * longer[k] * growth


@compiled
def add_links(p: KernelParameters, b: Any, q: Array, arm: Array, wrench: Array, twist: Array) -> None:
    """Add the platform twist of six single links, which are unequal in a pair and elastic.

    They carry the wrench at the tip and, where told so, the weight of the platform.

    Gamma has the columns (direction of link; its moment about P). Gamma f = w gives the link forces, and the link
    lengths change by dl = scale a |f|^b plus or minus half the difference of the pair. Gamma^T (dP; rotation) = dl is
    the twist.
    """
    _, n1, n2, n3 = leg_vectors(p, q[0], q[1], q[2])
    legs = (n1, n2, n3)
    gamma = np.empty((6, 6))
    for k in range(3):
        n = legs[k]
        length = math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
        u = np.array([n[0] / length, n[1] / length, n[2] / length])
        for j in range(2):
            gamma[:3, 2 * k + j] = u
            gamma[3:, 2 * k + j] = cross(b.platform_balls[2 * k + j], u)
    about = np.empty(6)
    about[:3] = wrench[:3]
    about[3:] = wrench[3:] + cross(arm, wrench[:3])
    about[2] -= b.link_weight
    longer = np.linalg.solve(gamma, about)
    for j in range(6):
        stiff = (longer[j] * longer[j] + LINK_FORCE * LINK_FORCE) ** (0.5 * (b.link_exponent - 1.0))
        longer[j] *= b.link_fraction[j // 2] * b.link_law * stiff
        longer[j] += (j % 2 - 0.5) * b.link_difference[j // 2]
    twist += np.linalg.solve(gamma.T.copy(), longer)


@compiled
def add_lumped(fraction: float, arm: Array, wrench: Array, twist: Array) -> None:
    """Add the twist of rails, roll and arm lumped at P: springs in yaw and pitch, one along x."""
    about_y = wrench[4] + arm[2] * wrench[0] - arm[0] * wrench[2]
    about_z = wrench[5] + arm[0] * wrench[1] - arm[1] * wrench[0]
    twist[0] += fraction * AXIAL_COMPLIANCE * wrench[0]
    twist[4] += fraction * about_y / PITCH_STIFFNESS
    twist[5] += fraction * about_z / YAW_STIFFNESS


@compiled
def bending_shift(compliance: float, rotation: Array, wrench: Array, shift: Array) -> None:
    """Add the shift [m] of a tool that bends across its axis, z of {t}."""
    axis = rotation[:, 2]
    along = axis[0] * wrench[0] + axis[1] * wrench[1] + axis[2] * wrench[2]
    for i in range(3):
        shift[i] += compliance * (wrench[i] - along * axis[i])


@compiled
def vibrate(b: Any, s: Any, acceleration: Array, shift: Array) -> None:
    """Advance one mode of the structure by a period and add its shift [m].

    x'' + 2 zeta w x' + w^2 x = -gain a, with the tip's acceleration a held over the period: exact for zeta < 1.
    """
    w, zeta, h = 2.0 * math.pi * b.mode_frequency, b.mode_damping, b.period
    damped = w * math.sqrt(1.0 - zeta * zeta)
    decay, c, sn = math.exp(-zeta * w * h), math.cos(damped * h), math.sin(damped * h)
    for i in range(3):
        rest = 0.0
        for j in range(3):
            rest -= b.mode_gain[i, j] * acceleration[j] / (w * w)
        x, v = s.mode_shift[i] - rest, s.mode_rate[i]
        side = (v + zeta * w * x) / damped
        s.mode_shift[i] = rest + decay * (x * c + side * sn)
        s.mode_rate[i] = decay * (v * c - (w * w * x + zeta * w * v) / damped * sn)
        shift[i] += s.mode_shift[i]


@compiled
def _add_found(
    b: Any, s: Any, state: Any, wrench: Array, tip_rate: Array, rotation: Array, position: Array, shift: Array
) -> None:
    """Look at what discovered formulas depend on, and add theirs to the shift [m] and to the rotation."""
    look_at_tip(b, s, state, wrench, tip_rate, rotation, position)
    twist = np.zeros(6)
    add_body(b.found, TIP, s, b.period, twist)
    shift += twist[:3]
    for k in range(3):
        rotation[:, k] += cross(twist[3:], rotation[:, k])


@compiled
def true_tip(
    p: KernelParameters,
    axis: Any,
    b: Any,
    s: Any,
    state: Any,
    q: Array,
    load: Array,
    wrench: Array,
    tip_rate: Array,
    jacobian: Array,
    rotation: Array,
    position: Array,
) -> None:
    """Write the true tip rotation (3, 3) and position (3,) [m] in {b}; advances the structure's mode by one period.

    Args:
        p: geometry of the true mechanism.
        axis: AXIS records.
        b: BODY record.
        s: BODY_STATE record, changed in place.
        state: AXIS_STATE records.
        q: (5,) true load positions; the slides' growth and the play behind the tilt slider are added in place.
        load: (5,) load on the axes [N, N m].
        wrench: (6,) contact wrench at the tip in {b}.
        tip_rate: (3,) tip velocity [m/s].
        jacobian: (6, 5) tip Jacobian near q.
        rotation: (3, 3), written.
        position: (3,), written.
    """
    warmth = b.temperature - REFERENCE_TEMPERATURE
    for i in range(5):
        q[i] *= 1.0 + axis[i].expansion * warmth
    q[4] -= 0.5 * axis[4].clearance * math.tanh(load[4] / CONTACT_FORCE)
    tip_pose_into(p, q, rotation, position)
    shift = np.zeros(3)
    if b.gives_way:
        centre, _, _, _ = leg_vectors(p, q[0], q[1], q[2])
        arm = position - np.array([centre[0], centre[1], centre[2]])
        twist = np.zeros(6)
        add_clearance(p, axis, q, load, jacobian, twist)
        add_lumped(b.lumped_fraction, arm, wrench, twist)
        if np.any(b.link_fraction != 0.0) or np.any(b.link_difference != 0.0):
            add_links(p, b, q, arm, wrench, twist)
        shift += twist[:3] + cross(twist[3:], arm)
        for k in range(3):
            rotation[:, k] += cross(twist[3:], rotation[:, k])
        bending_shift(b.bending, rotation, wrench, shift)
    if np.any(b.mode_gain != 0.0):
        vibrate(b, s, (tip_rate - s.tip_rate) / b.period, shift)
    if b.link_expansion != 0.0:
        add_growth(p, b.link_expansion * warmth, q, jacobian, shift)
    if b.arm_expansion != 0.0:
        centre, _, _, _ = leg_vectors(p, q[0], q[1], q[2])
        for i in range(3):
            shift[i] += b.arm_expansion * warmth * (position[i] - centre[i])
    if b.found_any:
        _add_found(b, s, state, wrench, tip_rate, rotation, position, shift)
    growth = b.expansion * warmth
    for i in range(3):
        s.tip_rate[i] = tip_rate[i]
        position[i] += growth * position[i] + shift[i]


@compiled
def quaternion(r: Array, out: Array) -> None:
    """Write the unit quaternion (x, y, z, w), w >= 0, of a rotation matrix (Shepperd 1978)."""
    trace = r[0, 0] + r[1, 1] + r[2, 2]
    if trace > 0.0:
        w = 0.5 * math.sqrt(1.0 + trace)
        f = 0.25 / w
        out[0], out[1], out[2], out[3] = (r[2, 1] - r[1, 2]) * f, (r[0, 2] - r[2, 0]) * f, (r[1, 0] - r[0, 1]) * f, w
        return
    i = int(np.argmax(np.array([r[0, 0], r[1, 1], r[2, 2]])))
    j, k = (i + 1) % 3, (i + 2) % 3
    x = 0.5 * math.sqrt(1.0 + r[i, i] - r[j, j] - r[k, k])
    f = 0.25 / x
    w = (r[k, j] - r[j, k]) * f
    sign = 1.0 if w >= 0.0 else -1.0
    out[i], out[j], out[k], out[3] = sign * x, sign * (r[i, j] + r[j, i]) * f, sign * (r[i, k] + r[k, i]) * f, sign * w
