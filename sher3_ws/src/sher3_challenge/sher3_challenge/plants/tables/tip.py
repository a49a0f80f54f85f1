"""Where the tip really is: kinematics with errors, play, springs that harden, two modes, a tool that sits loosely.

Small turns add up as vectors; the largest, of a soft arm, is a milliradian.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.signal import cont2discrete, lfilter
from scipy.spatial.transform import Rotation
from sher3_description import Robot
from sher3_description.contract import GRAVITY

from sher3_challenge.plants.compiled import compiled
from sher3_challenge.plants.plant import Array
from sher3_challenge.plants.tables.curves import CURVE, at, crept
from sher3_challenge.plants.tables.mechanism import tip_path
from sher3_challenge.plants.tables.parameters import TableParameters, Tip

BEAM = 0.5
"""Share of the arm's compliance that is a bending beam; the rest is a hinge at the platform."""
REST_FORCE = 0.3
"""Force at which a link rests on one side of its play [N]."""
FULL_FORCE = 2.0
"""Force at the end of the tables over the tip's force [N]."""
BALL_REACH = 6e-5
"""Travel of a slider over which a sticking ball joint turns over [m]."""


@compiled
def follow(x: Array, width: float, flank: Array) -> Array:
    """Return what follows `x` (n,) through a play of `width` whose take-up is the table `flank` over half the play."""
    out = np.empty(len(x))
    y = x[0]
    for k in range(len(x)):
        parts = 1
        if k > 0:
            parts = 1 + int(abs(x[k] - x[k - 1]) / (0.02 * width))
        for i in range(parts):
            before = x[max(0, k - 1)]
            now = before + (x[k] - before) * (i + 1) / parts
            dx = (x[k] - before) / parts
            behind = 2.0 * (now - y) / width
            if dx * behind > 0.0:
                y += dx * (1.0 if abs(behind) >= 1.0 else at(flank, abs(behind)))
            y = min(now + 0.5 * width, max(now - 0.5 * width, y))
        out[k] = y
    return out


@compiled
def turned_over(x: Array, reach: float, slope: Array) -> Array:
    """Return the hysteresis state (n,) in [-1, 1] along a path `x` (n,)."""
    out, z = np.zeros(len(x)), 0.0
    for k in range(1, len(x)):
        parts = 1 + int(abs(x[k] - x[k - 1]) / (0.1 * reach))
        for _ in range(parts):
            z = crept(z, (x[k] - x[k - 1]) / parts, reach, slope)
        out[k] = z
    return out


def tip_of(
    robot: Robot, p: TableParameters, q: Array, contact: Array, kelvin: Array, period: float
) -> tuple[Array, Array]:
    """Return tip positions (n, 3) and rotations (n, 3, 3) in the tracker's frame.

    Args:
        robot: the robot file, for the links' law and their balls.
        p: the robot as it is.
        q: (n, 5) true load positions.
        contact: (n, 3) force at the tip in {b}.
        kelvin: (n,) the body's temperature above 22 degC.
        period: time between ticks [s].
    """
    tip = p.tip
    x = q.copy()
    for row, axis in enumerate((0, 1, 2, 4)):
        if tip.follow[row] > 0.0:
            x[:, axis] = follow(np.ascontiguousarray(q[:, axis]), tip.follow[row], tip.flank)
    centres, points, turns = tip_path(p.mechanism, x, 1.0 + tip.expansion[0] * kelvin)
    arm = points - centres
    moved, turn = np.zeros_like(points), np.zeros_like(points)
    for part in (_warm_bow(p, x, kelvin, points), _arm(tip, arm, contact), _links(robot, p, x, centres, arm, contact)):
        moved, turn = moved + part[0], turn + part[1]
    bent, slope = _tool(p, turns, contact)
    moved, turn = moved + bent, turn + slope
    moved += _sticking(p, q)
    points = points + moved + _ringing(tip, points, period) + np.einsum("nij,j->ni", turns, tip.seat)
    points = points + np.einsum("nij,nj->ni", turns, _slipped(tip, turns, contact))
    turns = Rotation.from_rotvec(turn).as_matrix() @ turns
    base = Rotation.from_rotvec(tip.base_tilt).as_matrix()
    return points @ base.T, base @ turns


Part = tuple[Array, Array]


def _arm(tip: Tip, arm: Array, force: Array) -> Part:
    """Return displacement and turn of the arm: a hinge at the platform and a beam that turns half as much again."""
    along, *about = tip.spring
    size = np.linalg.norm(force, axis=1) / FULL_FORCE
    soft = np.interp(size, np.linspace(0, 1, CURVE), tip.hardening)[:, None]
    turn = soft * np.cross(arm, force) * np.array([0.0, *about])
    moved = np.cross(turn, arm)
    moved[:, 0] += along * soft[:, 0] * force[:, 0]
    return moved, (1 + 0.5 * BEAM) * turn


def _links(robot: Robot, p: TableParameters, q: Array, centres: Array, arm: Array, force: Array) -> Part:
    """Return displacement and turn by six links that give way under their forces, or rest on a side of their play."""
    tip = p.tip
    if not tip.link_law.any() and not tip.rattle.any():
        return np.zeros_like(arm), np.zeros_like(arm)
    pull, rows = link_forces(robot, p, q, centres, force, np.cross(arm, force))
    whole, _ = link_forces(robot, p, q, centres, force - [0, 0, GRAVITY * p.mechanism.masses[0]], np.cross(arm, force))
    law = robot.delta.link_compliance
    knots = np.concatenate([[0.0], np.geomspace(0.02, 40.0, 40)])
    sampled = np.interp(np.abs(pull), knots, law.a * robot.delta.spring_factor * knots**law.b)
    longer = tip.link_law * np.sign(pull) * sampled
    side = np.clip(whole / REST_FORCE, -1, 1)
    longer = longer + 0.25 * np.repeat(tip.rattle, 2) * side * (3 - side**2)
    pose = np.linalg.solve(rows, longer[:, :, None])[:, :, 0]
    return pose[:, :3] + np.cross(pose[:, 3:], arm), pose[:, 3:]


def link_forces(
    robot: Robot, p: TableParameters, q: Array, centres: Array, force: Array, torque: Array
) -> tuple[Array, Array]:
    """Return the tension (n, 6) of the links under a force and a torque about P, and their rows (n, 6, 6).

    A row times a displacement and a small turn of the platform is the change of a link's length.
    """
    delta = robot.delta
    half = delta.leg_width / 2
    azimuth = np.repeat(np.asarray(delta.leg_azimuth), 2)
    inner = math.sqrt(delta.platform_radius**2 - half**2)
    side = np.tile([half, -half], 3)
    ball = np.column_stack(
        [inner * np.cos(azimuth) - side * np.sin(azimuth), inner * np.sin(azimuth) + side * np.cos(azimuth), 0 * side]
    )
    g = p.mechanism
    centre = g.centre[None] + q[:, :3, None] * g.rail[None]
    along = np.repeat(centres[:, None] - centre, 2, axis=1)
    along /= np.linalg.norm(along, axis=2, keepdims=True)
    rows = np.concatenate([along, np.cross(np.broadcast_to(ball, along.shape), along)], axis=2)
    wrench = np.concatenate([force, torque], axis=1)
    return np.linalg.solve(rows.transpose(0, 2, 1), wrench[:, :, None])[:, :, 0], rows


def _tool(p: TableParameters, turns: Array, force: Array) -> Part:
    """Return displacement and turn of a tool that bends across its axis and hardens."""
    local = np.einsum("nji,nj->ni", turns, force)
    across = p.tip.bending[0] * local * np.array([1.0, 1.0, 0.0])
    size = np.linalg.norm(local[:, :2], axis=1) / FULL_FORCE
    across *= np.interp(size, np.linspace(0, 1, CURVE), p.tip.hardening)[:, None]
    tool = p.mechanism.arm[3:]
    length = np.linalg.norm(tool)
    slope = 1.5 * np.cross(tool / length, across) / length
    return np.einsum("nij,nj->ni", turns, across), np.einsum("nij,nj->ni", turns, slope)


def _warm_bow(p: TableParameters, q: Array, kelvin: Array, points: Array) -> Part:
    """Return the displacement by rails that bow with temperature: a parabola over the stroke, across the rail."""
    moved = np.zeros_like(points)
    for leg in range(3):
        if p.tip.bow_warm[leg] != 0.0:
            bow = p.tip.bow_warm[leg] * kelvin * (q[:, leg] / 4e-3 + 0.5) ** 2
            azimuth = 2 * math.pi * leg / 3
            moved += bow[:, None] * np.array([math.cos(azimuth), math.sin(azimuth), 0.3])
    return moved, np.zeros_like(points)


def _ringing(tip: Tip, points: Array, period: float) -> Array:
    """Return (n, 3) what two modes add when the tip accelerates, each exact over a tick with held acceleration."""
    added = np.zeros_like(points)
    for (frequency, damping, gain), axis in zip(tip.modes, tip.mode_axis.astype(int), strict=True):
        if gain == 0.0:
            continue
        omega = 2 * math.pi * frequency
        accelerated = np.zeros(len(points))
        accelerated[1:-1] = np.diff(points[:, axis], 2) / period**2
        top, bottom, _ = cont2discrete(([-gain], [1.0, 2 * damping * omega, omega**2]), period, method="zoh")
        added[:, axis] += lfilter(top.ravel(), bottom, accelerated)
    return added


def _sticking(p: TableParameters, q: Array) -> Array:
    """Return (n, 3) the shift by ball joints that stick: across the motion of the first slider, by its direction."""
    moved = np.zeros((len(q), 3))
    if p.tip.stiction[0] != 0.0:
        state = turned_over(np.ascontiguousarray(q[:, 0]), BALL_REACH, p.motor.slope[0])
        moved[:, 1] = p.tip.stiction[0] * state
    return moved


def _slipped(tip: Tip, turns: Array, force: Array) -> Array:
    """Return (n, 3) in {t} where the tool has slipped to in its holder: only forces beyond a limit move it."""
    gone = np.zeros_like(force)
    if tip.slip[0] != 0.0:
        local = np.einsum("nji,nj->ni", turns, force) * np.array([1.0, 1.0, 0.0])
        here = np.zeros(3)
        for k in range(len(force)):
            lead = local[k] - here / tip.slip[0]
            size = float(np.linalg.norm(lead))
            if size > tip.slip[1]:
                here = here + tip.slip[0] * (size - tip.slip[1]) * lead / size
            gone[k] = here
    return gone
