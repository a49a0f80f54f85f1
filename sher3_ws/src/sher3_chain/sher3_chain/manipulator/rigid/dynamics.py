"""The forces that the motion of a tree of rigid bodies needs, of many samples at once.

Newton and Euler's equations of a body are linear in its inertial parameters (Atkeson, An and Hollerbach, IJRR 1986):
its wrench is a matrix (6, 10) of its motion times them, and its Jacobian brings it to the joints.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from sher3_common.numbers.cross import cross, skew
from sher3_diagnosis.channel import Array

from sher3_chain.manipulator.rigid.tree import MATRIX, PARAMETERS, WORLD, Link, Tree

SAMPLES = 1024
"""Samples that are reckoned at once: few enough to stay in the cache."""


@dataclass(frozen=True)
class _Motion:
    """Of a link's frame at its origin, in its own axes.

    Attributes:
        turning, sliding: Jacobian to its angular and linear velocity, (n, links, 3) each.
        rate, growth: angular velocity and acceleration, (n, 3).
        acceleration: of its origin, less gravity, (n, 3).
    """

    turning: Array
    sliding: Array
    rate: Array
    growth: Array
    acceleration: Array


def regressor(tree: Tree, q: Array, v: Array, a: Array) -> Array:
    """Return the force that each inertial parameter asks of each joint, (n, links, 10 links).

    Args:
        tree: with k joints.
        q: their positions, m or rad, (n, k).
        v: velocities.
        a: accelerations.
    """
    out = np.zeros((len(q), len(tree.links), PARAMETERS * len(tree.links)))
    for rows in _pieces(len(q)):
        for i, motion in enumerate(_motions(tree, q[rows], v[rows], a[rows])):
            force, moment = _wrenches(motion)
            out[rows, :, PARAMETERS * i : PARAMETERS * (i + 1)] = motion.turning @ moment + motion.sliding @ force
    return out


def forces(tree: Tree, inertial: Array, q: Array, v: Array, a: Array) -> Array:
    """Return the force that each joint needs, (n, k), without rotors; `inertial` (10 links,) are the bodies'."""
    out = np.zeros(q.shape)
    for rows in _pieces(len(q)):
        motions = _motions(tree, q[rows], v[rows], a[rows])
        for own, motion in zip(inertial.reshape(-1, PARAMETERS), motions, strict=True):
            force, moment = ((w @ own)[..., None] for w in _wrenches(motion))
            out[rows] += (motion.turning @ moment + motion.sliding @ force)[..., 0]
    return out


def _pieces(count: int) -> Iterator[slice]:
    return (slice(i, i + SAMPLES) for i in range(0, count, SAMPLES))


def _motions(tree: Tree, q: Array, v: Array, a: Array) -> Iterator[_Motion]:
    """Motion of every link, from the base outwards."""
    still = np.zeros((len(q), 3))
    none = np.zeros((len(q), len(tree.links), 3))
    base = _Motion(none, none, still, still, still - tree.gravity)
    known: list[_Motion] = []
    for i, link in enumerate(tree.links):
        before = base if link.parent == WORLD else known[link.parent]
        known.append(_carried(link, i, before, q[:, i], v[:, i, None], a[:, i, None]))
        yield known[-1]


def _carried(link: Link, i: int, before: _Motion, q: Array, v: Array, a: Array) -> _Motion:
    """Motion of a link from that of the one before it."""
    turn = link.turn if link.slides else link.turn @ _turned(link.axis, q)
    place = link.place + (np.outer(q, link.turn @ link.axis) if link.slides else np.zeros((len(q), 3)))
    omega = before.rate
    origin = before.acceleration + cross(before.growth, place) + cross(omega, cross(omega, place))
    turning = before.turning @ turn
    sliding = (before.sliding + cross(before.turning, place[:, None])) @ turn
    (sliding if link.slides else turning)[:, i] += link.axis
    rate, growth, acceleration = (_back(x, turn) for x in (omega, before.growth, origin))
    beside = cross(rate, link.axis * v)
    if link.slides:
        return _Motion(turning, sliding, rate, growth, acceleration + link.axis * a + 2.0 * beside)
    return _Motion(turning, sliding, rate + link.axis * v, growth + link.axis * a + beside, acceleration)


def _wrenches(motion: _Motion) -> tuple[Array, Array]:
    """Force and moment about its origin, (n, 3, 10) each, that a body needs for each of its inertial parameters."""
    force, moment = (np.zeros((len(motion.rate), 3, PARAMETERS)) for _ in range(2))
    spin = skew(motion.rate)
    force[:, :, 0] = motion.acceleration
    force[:, :, 1:4] = skew(motion.growth) + spin @ spin
    moment[:, :, 1:4] = -skew(motion.acceleration)
    moment[:, :, 4:] = _spread(motion.growth) + spin @ _spread(motion.rate)
    return force, moment


def _spread(x: Array) -> Array:
    """Matrix (n, 3, 6) that times the six of an inertia is the inertia times x (n, 3)."""
    out = np.zeros((len(x), 3, 6))
    for row, columns in enumerate(MATRIX):
        out[:, row, columns] = x
    return out


def _turned(axis: Array, angle: Array) -> Array:
    """Rotations (n, 3, 3) about a unit axis by angles (n,), by Rodrigues' formula."""
    one = skew(axis[None])[0]
    return np.eye(3) + np.sin(angle)[:, None, None] * one + (1.0 - np.cos(angle))[:, None, None] * (one @ one)


def _back(x: Array, turn: Array) -> Array:
    """Vectors (n, 3) in the axes that a rotation (n, 3, 3) or (3, 3) turns to."""
    return (x[:, None] @ turn)[:, 0]
