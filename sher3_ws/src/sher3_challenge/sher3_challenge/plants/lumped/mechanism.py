"""The mechanism solved numerically: platform pose on six ball-jointed links by Newton's method, then the arm.

Each link has its own balls and length, so errors also turn the platform; the closed form for parallel links cannot.
"""

from __future__ import annotations

import math

import numpy as np
from sher3_description.contract import GRAVITY

from sher3_challenge.plants.compiled import compiled, compiled_inner
from sher3_challenge.plants.lumped.parameters import Array, Geometry

TOLERANCE = 1e-15  # of the squared lengths: 1e-14 m of a link


@compiled
def rotation(w: Array) -> Array:
    """Return the rotation matrix (3, 3) of a rotation vector (3,) [rad] (Rodrigues)."""
    angle = math.sqrt(w[0] ** 2 + w[1] ** 2 + w[2] ** 2)
    a, b = (1.0, 0.5) if angle < 1e-9 else (math.sin(angle) / angle, (1 - math.cos(angle)) / angle**2)
    k = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
    return np.eye(3) + a * k + b * (k @ k)


@compiled_inner
def cross(u: Array, v: Array) -> Array:
    """Return the cross product (3,); numpy's own, for any axes, takes 5 s of processor more to compile."""
    return np.array([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])


@compiled
def link_rows(g: Geometry, pose: Array, turn: Array, s: Array, length: Array) -> tuple[Array, Array, Array]:
    """Return residuals (6,) and their Jacobians by the pose, P and a rotation vector, and by the sliders (6, 3)."""
    residual, by_pose, by_slider = np.empty(6), np.empty((6, 6)), np.zeros((6, 3))
    for i in range(6):
        leg = i // 2
        ball = turn @ g.platform_ball[i]
        u = pose[:3] + ball - g.rail_ball[i] - s[leg] * g.rail[leg]
        residual[i] = u[0] ** 2 + u[1] ** 2 + u[2] ** 2 - length[i] ** 2
        by_pose[i, :3] = 2 * u
        by_pose[i, 3] = 2 * (ball[1] * u[2] - ball[2] * u[1])
        by_pose[i, 4] = 2 * (ball[2] * u[0] - ball[0] * u[2])
        by_pose[i, 5] = 2 * (ball[0] * u[1] - ball[1] * u[0])
        by_slider[i, leg] = -2 * (u[0] * g.rail[leg, 0] + u[1] * g.rail[leg, 1] + u[2] * g.rail[leg, 2])
    return residual, by_pose, by_slider


@compiled
def solve_platform(g: Geometry, s: Array, length: Array, pose: Array) -> Array:
    """Move `pose` (6,) in place to the platform pose at slider positions `s`; return its Jacobian (6, 3)."""
    for _ in range(12):
        residual, by_pose, by_slider = link_rows(g, pose, rotation(pose[3:]), s, length)
        if np.abs(residual).max() < TOLERANCE:
            break
        pose -= np.linalg.solve(by_pose, residual)
    return -np.linalg.solve(by_pose, by_slider)


@compiled
def link_forces(g: Geometry, pose: Array, s: Array, force: Array, torque: Array) -> Array:
    """Return (6,) tension of the links that balances a force and a torque (about P) on the platform."""
    turn = rotation(pose[3:])
    wrench_of = np.empty((6, 6))
    for i in range(6):
        leg = i // 2
        ball = turn @ g.platform_ball[i]
        u = g.rail_ball[i] + s[leg] * g.rail[leg] - pose[:3] - ball
        n = u / np.sqrt((u * u).sum())
        wrench_of[:3, i] = n
        wrench_of[3:, i] = cross(ball, n)
    return -np.linalg.solve(wrench_of, np.concatenate((force, torque)))


@compiled
def tilt_angle(g: Geometry, q: float, guess: float) -> tuple[float, float]:
    """Return the tilt angle at slider travel `q`, by Newton's method, and its derivative d angle / d q."""
    r, c, e = g.linkage[0], g.linkage[1], g.linkage[2]
    angle, slope = guess, r
    for _ in range(20):
        height = e - r * math.cos(angle)
        root = math.sqrt(c * c - height * height)
        slope = r * math.cos(angle) - height * r * math.sin(angle) / root
        step = (r * math.sin(angle) + root - g.linkage_zero[0] - q) / slope
        angle -= step
        if abs(step) < 1e-15:
            break
    return angle, 1.0 / slope


@compiled
def arm_pose(g: Geometry, pose: Array, roll: float, angle: float) -> tuple[Array, Array]:
    """Return tip position (3,) and rotation (3, 3) in {b} for a platform pose, roll and tilt angle."""
    base = rotation(pose[3:])
    rolled = base @ rotation(np.array([roll, 0.0, 0.0]))
    turned = rolled @ rotation(np.array([0.0, angle, 0.0]))
    tip = pose[:3] + base @ np.array([0.0, 0.0, g.arm[0]]) + rolled @ np.array([g.arm[1], 0.0, g.arm[2]])
    return tip + turned @ g.arm[3:], turned


@compiled
def load_forces(g: Geometry, q: Array, pose: Array, force: Array) -> tuple[Array, Array]:
    """Return (5,) gravity G(q) and (5,) external force of `force` at the tip; `pose` is updated in place."""
    by_slider = solve_platform(g, q[:3], g.link, pose)
    angle, by_tilt = tilt_angle(g, q[4], q[4] / g.linkage[0])
    base = rotation(pose[3:])
    rolled = base @ rotation(np.array([q[3], 0.0, 0.0]))
    turned = rolled @ rotation(np.array([0.0, angle, 0.0]))
    bracket = pose[:3] + base @ np.array([0.0, 0.0, g.arm[0]])
    elbow = bracket + rolled @ np.array([g.arm[1], 0.0, g.arm[2]])
    tip = elbow + turned @ g.arm[3:]
    gravity, external = np.zeros(5), np.zeros(5)
    arm = tip - pose[:3]
    for k in range(3):
        move, turn = by_slider[:3, k], by_slider[3:, k]
        gravity[k] = g.masses[0] * GRAVITY * move[2]
        external[k] = (move * force).sum() + (cross(turn, arm) * force).sum()
    roll_axis, tilt_axis = base[:, 0], rolled[:, 1]
    roll_com, tilt_com = bracket + rolled @ g.roll_com, elbow + turned @ g.tilt_com
    gravity[3] = GRAVITY * (
        g.masses[1] * cross(roll_axis, roll_com - bracket)[2] + g.masses[2] * cross(roll_axis, tilt_com - bracket)[2]
    )
    gravity[4] = GRAVITY * g.masses[2] * cross(tilt_axis, tilt_com - elbow)[2] * by_tilt
    external[3] = (cross(roll_axis, tip - bracket) * force).sum()
    external[4] = (cross(tilt_axis, tip - elbow) * force).sum() * by_tilt
    return gravity, external
