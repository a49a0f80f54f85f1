"""Kinematics and statics from the contract's text: a leg's end runs on a sphere, three spheres meet in the platform.

The links of a leg stay parallel, so the platform does not turn. The tilt angle is a table over the slider's travel.
"""

from __future__ import annotations

import math

import numpy as np
from sher3_description.contract import GRAVITY

from sher3_challenge.plants.compiled import compiled, compiled_inner
from sher3_challenge.plants.plant import Array
from sher3_challenge.plants.tables.parameters import Mechanism

NODES = 1500
"""Nodes of the table of the tilt angle: with slopes, 32 um apart, it is good to 1e-13 rad."""


def slider_travel(linkage: Array, angle: Array) -> Array:
    """Return the slider's travel (n,) for tilt angles (n,): x(angle) - x(0), x = r sin + sqrt(l^2 - (e - r cos)^2)."""
    r, length, e = linkage

    def x(a: Array) -> Array:
        return np.asarray(r * np.sin(a) + np.sqrt(length**2 - (e - r * np.cos(a)) ** 2))

    return x(angle) - x(np.zeros(1))


def angle_table(linkage: Array, travel: Array) -> Array:
    """Return (2, NODES) the tilt angle and its slope over the slider's travel, by bisection at every node."""
    wanted = np.linspace(travel[0], travel[1], NODES)
    low, high = np.full(NODES, -1.3), np.full(NODES, 1.3)
    for _ in range(60):
        middle = 0.5 * (low + high)
        above = slider_travel(linkage, middle) > wanted
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    angle, step = 0.5 * (low + high), 1e-4
    slope = (slider_travel(linkage, angle + step) - slider_travel(linkage, angle - step)) / (2 * step)
    third = slider_travel(linkage, angle + 2 * step) - slider_travel(linkage, angle - 2 * step)
    slope += (slope - third / (4 * step)) / 3  # Richardson
    return np.array([angle, 1.0 / slope])


@compiled_inner
def tilt_angle(g: Mechanism, q: float) -> tuple[float, float]:
    """Return the tilt angle and its derivative by the slider, a cubic between nodes (Hermite)."""
    h = (g.travel[1] - g.travel[0]) / (NODES - 1)
    u = (q - g.travel[0]) / h
    i = min(max(int(u), 0), NODES - 2)
    t = u - i
    a, b, da, db = g.angle[0, i], g.angle[0, i + 1], h * g.angle[1, i], h * g.angle[1, i + 1]
    c2, c3 = 3 * (b - a) - 2 * da - db, 2 * (a - b) + da + db
    return a + t * (da + t * (c2 + t * c3)), (da + t * (2 * c2 + 3 * t * c3)) / h


@compiled_inner
def leg_centre(g: Mechanism, leg: int, s: float) -> tuple[float, float, float]:
    """Return the centre of a leg's sphere at slider travel `s`: along a rail that leans and is not quite straight."""
    u = (s - g.stroke[0]) / (g.stroke[1] - g.stroke[0]) * (g.bow.shape[2] - 1)
    i = min(max(int(u), 0), g.bow.shape[2] - 2)
    t = u - i
    x = g.bow[leg, 0, i] + t * (g.bow[leg, 0, i + 1] - g.bow[leg, 0, i])
    y = g.bow[leg, 1, i] + t * (g.bow[leg, 1, i + 1] - g.bow[leg, 1, i])
    rail, centre = g.rail[leg], g.centre[leg]
    return centre[0] + s * rail[0] + x, centre[1] + s * rail[1] + y, centre[2] + s * rail[2]


ROOM = 12
"""Rows of the work space of `platform`."""


@compiled_inner
def _cross(r: Array, i: int, j: int, out: int) -> None:
    """Write the cross product of the rows `i` and `j` into the row `out`."""
    r[out, 0] = r[i, 1] * r[j, 2] - r[i, 2] * r[j, 1]
    r[out, 1] = r[i, 2] * r[j, 0] - r[i, 0] * r[j, 2]
    r[out, 2] = r[i, 0] * r[j, 1] - r[i, 1] * r[j, 0]


@compiled_inner
def _dot(r: Array, i: int, j: int) -> float:
    """Return the scalar product of the rows `i` and `j`."""
    return r[i, 0] * r[j, 0] + r[i, 1] * r[j, 1] + r[i, 2] * r[j, 2]


@compiled_inner
def platform(g: Mechanism, q: Array, grown: float, r: Array) -> None:
    """Write the platform's centre and its velocity per slider into the rows 0 to 3 of `r` (ROOM, 3).

    All lengths but the scales are multiplied by `grown`. Rows 4 to 6 keep the spheres' centres. With u and v from the
    first centre to the others and w = u x v, the centre lies at (a (v x w) + b (w x u)) / w^2 + h w from the first one.
    """
    for leg in range(3):
        x, y, z = leg_centre(g, leg, q[leg])
        r[4 + leg, 0], r[4 + leg, 1], r[4 + leg, 2] = x * grown, y * grown, z
    for i in range(3):
        r[7, i], r[8, i] = r[5, i] - r[4, i], r[6, i] - r[4, i]
    _cross(r, 7, 8, 9)
    _cross(r, 8, 9, 10)
    _cross(r, 9, 7, 11)
    ww = _dot(r, 9, 9)
    l0, l1, l2 = (g.length[0] * grown) ** 2, (g.length[1] * grown) ** 2, (g.length[2] * grown) ** 2
    a, b = 0.5 * (l0 - l1 + _dot(r, 7, 7)) / ww, 0.5 * (l0 - l2 + _dot(r, 8, 8)) / ww
    for i in range(3):
        r[0, i] = a * r[10, i] + b * r[11, i]
    height = math.sqrt((l0 - _dot(r, 0, 0)) / ww)
    for i in range(3):
        r[0, i] += r[4, i] + height * r[9, i]
        for leg in range(3):
            r[7 + leg, i] = r[0, i] - r[4 + leg, i]
    for leg in range(3):
        _cross(r, 7 + (leg + 1) % 3, 7 + (leg + 2) % 3, leg + 1)
        own = 7 + leg
        along = r[own, 0] * g.rail[leg, 0] + r[own, 1] * g.rail[leg, 1] + r[own, 2] * g.rail[leg, 2]
        scale = along / _dot(r, own, leg + 1)
        for i in range(3):
            r[leg + 1, i] *= scale


@compiled
def load_forces(g: Mechanism, q: Array, force: Array, gravity: Array, external: Array, pose: Array) -> None:
    """Write gravity G(q) (5,) and the actuator forces (5,) of a force at the tip; `pose` (ROOM, 3) is work space."""
    platform(g, q, 1.0, pose)
    for leg in range(3):
        move = pose[leg + 1]
        gravity[leg] = g.masses[0] * GRAVITY * move[2]
        external[leg] = move[0] * force[0] + move[1] * force[1] + move[2] * force[2]
    angle, by_slider = tilt_angle(g, q[4])
    cr, sr, ct, st = math.cos(q[3]), math.sin(q[3]), math.cos(angle), math.sin(angle)
    arm, com = g.arm, g.tilt_com
    lift = arm[2] - st * com[0] + ct * com[2]
    roll = g.masses[1] * (cr * g.roll_com[1] - sr * g.roll_com[2]) + g.masses[2] * (cr * com[1] - sr * lift)
    gravity[3] = GRAVITY * roll
    gravity[4] = -GRAVITY * g.masses[2] * cr * (ct * com[0] + st * com[2]) * by_slider
    across, up = ct * arm[3] + st * arm[5], -st * arm[3] + ct * arm[5]
    y, z = cr * arm[4] - sr * (arm[2] + up), sr * arm[4] + cr * (arm[2] + up)
    external[3] = y * force[2] - z * force[1]
    external[4] = (up * force[0] - across * (cr * force[2] - sr * force[1])) * by_slider


@compiled
def tip_path(g: Mechanism, q: Array, grown: Array) -> tuple[Array, Array, Array]:
    """Return platform centres (n, 3), tips (n, 3) and rotations of {t} (n, 3, 3) for load positions (n, 5).

    Args:
        g: the mechanism.
        q: (n, 5) positions.
        grown: (n,) factor of all lengths but the scales.
    """
    n = len(q)
    centres, tips, turns, pose = np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 3, 3)), np.empty((ROOM, 3))
    for k in range(n):
        platform(g, q[k], grown[k], pose)
        angle = tilt_angle(g, q[k, 4] / grown[k])[0]
        cr, sr, ct, st = math.cos(q[k, 3]), math.sin(q[k, 3]), math.cos(angle), math.sin(angle)
        turns[k, 0, 0], turns[k, 0, 1], turns[k, 0, 2] = ct, 0.0, st
        turns[k, 1, 0], turns[k, 1, 1], turns[k, 1, 2] = sr * st, cr, -sr * ct
        turns[k, 2, 0], turns[k, 2, 1], turns[k, 2, 2] = -cr * st, sr, cr * ct
        arm = g.arm * grown[k]
        x = arm[1] + ct * arm[3] + st * arm[5]
        z = arm[2] - st * arm[3] + ct * arm[5]
        centres[k] = pose[0]
        tips[k, 0] = pose[0, 0] + x
        tips[k, 1] = pose[0, 1] + cr * arm[4] - sr * z
        tips[k, 2] = pose[0, 2] + arm[0] + sr * arm[4] + cr * z
    return centres, tips, turns
