"""Where the platform and the tip are, all ticks at once: six links by Newton's method, then the arm."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from sher3_challenge.plants.mujoco.axes.parts import Array
from sher3_challenge.plants.mujoco.rig import Mechanism

TOLERANCE = 1e-15  # m^2, of the squared lengths: 1e-14 m of a link
LEGS = np.repeat(np.arange(3), 2)


def grown(m: Mechanism, kelvin: float) -> Mechanism:
    """Return the mechanism at `kelvin` above its reference temperature; the scales of the rails do not grow."""
    k = 1 + m.expansion * kelvin
    return Mechanism(
        m.rail_ball * k, m.rail, m.platform_ball * k, m.link * k, m.arm * k, m.linkage * k, m.base_turn, m.base_shift
    )


def link_vectors(m: Mechanism, pose: Array, sliders: Array) -> tuple[Array, Array]:
    """Return (n, 6, 3) links from carriage to platform ball and (n, 6, 3) platform balls about P, in {b}.

    Args:
        m: the mechanism.
        pose: (n, 6) of the platform, P and a rotation vector.
        sliders: (n, 3) travel at the mechanism.
    """
    ball = np.einsum("nij,kj->nki", Rotation.from_rotvec(pose[:, 3:]).as_matrix(), m.platform_ball)
    carriage = m.rail_ball + sliders[:, LEGS, None] * m.rail[LEGS]
    return pose[:, None, :3] + ball - carriage, ball


def platform(m: Mechanism, sliders: Array, change: Array | None = None) -> Array:
    """Return (n, 6) platform poses, P and a rotation vector.

    Args:
        m: the mechanism.
        sliders: (n, 3) travel of the sliders.
        change: (n, 6) what is added to the links, m.
    """
    pose = np.zeros((len(sliders), 6))
    pose[:, 2] = 0.05 + sliders.mean(axis=1)
    length = m.link if change is None else m.link + change
    for _ in range(8):
        u, ball = link_vectors(m, pose, sliders)
        error = np.einsum("nki,nki->nk", u, u) - length**2
        if np.abs(error).max() < TOLERANCE:
            break
        slope = 2 * np.concatenate([u, np.cross(ball, u)], axis=2)
        pose -= np.linalg.solve(slope, error[:, :, None])[:, :, 0]  # turns are small enough to add up
    return pose


def link_tension(m: Mechanism, pose: Array, sliders: Array, force: Array, torque: Array) -> Array:
    """Return (n, 6) tension of the links under a force and a torque about P on the platform (n, 3)."""
    u, ball = link_vectors(m, pose, sliders)
    along = -u / np.linalg.norm(u, axis=2, keepdims=True)
    wrench_of = np.concatenate([along, np.cross(ball, along)], axis=2).transpose(0, 2, 1)
    return np.asarray(-np.linalg.solve(wrench_of, np.hstack([force, torque])[:, :, None])[:, :, 0])


def tilt_angle(m: Mechanism, q: Array) -> Array:
    """Return (n,) the tilt angle: intersection of the coupler's circle with the crank's, the axis homed at zero."""
    crank, coupler, offset = m.linkage
    x = q + m.linkage_zero
    reach = np.hypot(x, offset)
    # the angle between the line to the slider's ball and the crank, by the law of cosines
    between = np.arccos((reach**2 + crank**2 - coupler**2) / (2 * reach * crank))
    return np.asarray(np.arctan2(x, offset) - between)


def arm(m: Mechanism, pose: Array, roll: Array, angle: Array) -> tuple[Array, Rotation]:
    """Return tip positions (n, 3) and rotations of {t} in {b}."""
    zero = np.zeros_like(roll)
    base = Rotation.from_rotvec(pose[:, 3:])
    rolled = base * Rotation.from_rotvec(np.column_stack([roll, zero, zero]))
    turn = rolled * Rotation.from_rotvec(np.column_stack([zero, angle, zero]))
    tip = pose[:, :3] + base.apply([0.0, 0.0, m.arm[0]]) + rolled.apply([m.arm[1], 0.0, m.arm[2]])
    return tip + turn.apply(m.arm[3:]), turn
