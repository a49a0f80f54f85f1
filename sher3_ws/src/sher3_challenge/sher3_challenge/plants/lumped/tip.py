"""Where the tip really is: errors of the six links, clearance, expansion, deflection, vibration."""

from __future__ import annotations

import math

import numpy as np
from sher3_description.contract import GRAVITY

from sher3_challenge.plants.compiled import compiled, compiled_inner
from sher3_challenge.plants.lumped.hysteresis import ELEMENTS, play_offset
from sher3_challenge.plants.lumped.mechanism import arm_pose, cross, link_forces, rotation, solve_platform, tilt_angle
from sher3_challenge.plants.lumped.parameters import Array, Geometry

OUTER_HINGE = 0.05
"""Distance from P along the arm at which the outer part of the structural compliance sits [m]."""


@compiled_inner
def grown(g: Geometry, kelvin: float) -> Geometry:
    """Return the geometry at `kelvin` above its reference temperature; the rails' scale does not grow."""
    k = 1 + g.expansion[0] * kelvin
    return Geometry(
        g.rail_ball * k, g.rail, g.platform_ball * k, g.link * k, g.clearance, g.rattle, g.arm * k, g.linkage * k,
        g.linkage_zero * k, g.base_tilt, g.expansion, g.bending, g.hinge, g.link_law, g.vibration, g.parasitic,
        g.masses, g.roll_com, g.tilt_com,
    )  # fmt: skip


@compiled_inner
def stretched(g: Geometry, pose: Array, s: Array, tip: Array, force: Array) -> Array:
    """Return (6,) link lengths under a force at the tip: a |F|^b per link, finite slope at zero, rattling legs.

    The links' deflection is counted from the one under gravity alone; a rattling leg feels gravity too.
    """
    length = g.link.copy()
    torque = cross(tip - pose[:3], force)
    tension = link_forces(g, pose, s, force, torque)
    whole = link_forces(g, pose, s, force + np.array([0.0, 0.0, -GRAVITY * g.masses[0]]), torque)
    for i in range(6):
        f = tension[i]
        length[i] += g.link_law[0] * f * (f * f + 0.01) ** (0.5 * (g.link_law[1] - 1.0))
        length[i] += 0.5 * g.rattle[i // 2] * math.tanh(whole[i] / 0.25)
    return length


@compiled_inner
def deflected(g: Geometry, pose: Array, tip: Array, turn: Array, force: Array) -> tuple[Array, Array]:
    """Return tip (3,) and rotation (3, 3) under a force at the tip: hinges at P and on the arm, then the tool."""
    hinge = g.hinge
    if hinge[0] != 0.0 or hinge[3] != 0.0 or hinge[2] != 0.0:
        outer = pose[:3] + np.array([OUTER_HINGE, 0.0, g.arm[0]])
        inner_arm, outer_arm = tip - pose[:3], tip - outer
        bend = (1 - hinge[4]) * hinge[1:4] * cross(inner_arm, force)
        flex = hinge[4] * hinge[1:4] * cross(outer_arm, force)
        tip = tip + cross(bend, inner_arm) + cross(flex, outer_arm)
        tip[0] += hinge[0] * force[0]
        turn = rotation(bend + flex) @ turn
    if g.bending[0] != 0.0:
        local = turn.T @ force
        across = np.array([g.bending[0] * local[0], g.bending[0] * local[1], 0.0])
        tool = g.arm[3:]
        length = math.sqrt((tool * tool).sum())
        slope = 1.5 * cross(tool / length, across) / length
        tip = tip + turn @ across
        turn = turn @ rotation(slope)
    return tip, turn


@compiled
def follow_tip(g: Geometry, q: Array, contact: Array, kelvin: Array, period: float) -> tuple[Array, Array]:
    """Return tip positions (n, 3) and rotations (n, 3, 3) in the tracker's frame.

    Args:
        g: the mechanism.
        q: (n, 5) true load positions.
        contact: (n, 3) force at the tip in {b}.
        kelvin: (n,) temperature above 22 degC.
        period: time between ticks [s].
    """
    n = len(q)
    tips, turns = np.empty((n, 3)), np.empty((n, 3, 3))
    pose = np.zeros(6)
    pose[2] = 0.05 + q[0, :3].mean()
    follower = np.zeros((3, ELEMENTS))
    for leg in range(3):
        follower[leg] = q[0, leg]
    base = rotation(g.base_tilt)
    for k in range(n):
        warm = grown(g, kelvin[k])
        s = q[k, :3].copy()
        for leg in range(3):
            if g.clearance[leg] != 0.0:
                s[leg] += play_offset(s[leg], g.clearance[leg], follower[leg])
        solve_platform(warm, s, warm.link, pose)
        angle = tilt_angle(warm, q[k, 4], q[k, 4] / g.linkage[0])[0]
        tip, turn = arm_pose(warm, pose, q[k, 3], angle)
        if g.link_law[0] != 0.0 or g.rattle.any():
            bent = pose.copy()
            solve_platform(warm, s, stretched(warm, pose, s, tip, contact[k]), bent)
            tip, turn = arm_pose(warm, bent, q[k, 3], angle)
        tip, turn = deflected(warm, pose, tip, turn, contact[k])
        tips[k], turns[k] = base @ tip, base @ turn
    _vibrate(g, tips, period)
    if g.parasitic[0] != 0.0:
        speed = np.zeros((n, 3))
        speed[1:] = (tips[1:] - tips[:-1]) / period
        tips[:, 0] -= g.parasitic[0] * speed[:, 1]
        tips[:, 1] += g.parasitic[0] * speed[:, 0]
        tips[:, 2] += g.parasitic[1] * np.abs(speed[:, 2])
    return tips, turns


@compiled_inner
def _vibrate(g: Geometry, tips: Array, period: float) -> None:
    """Add the structure's mode, excited by the acceleration of the tip (semi-implicit Euler, ten steps per tick)."""
    gain, frequency, damping = g.vibration[0], g.vibration[1], g.vibration[2]
    if gain == 0.0:
        return
    axis = int(g.vibration[3])
    omega, h = 2 * math.pi * frequency, period / 10
    rigid = tips[:, axis].copy()
    x = speed = 0.0
    for k in range(1, len(tips) - 1):
        acceleration = (rigid[k + 1] - 2 * rigid[k] + rigid[k - 1]) / period**2
        for _ in range(10):
            speed += h * (-gain * acceleration - 2 * damping * omega * speed - omega * omega * x)
            x += h * speed
        tips[k + 1, axis] += x
