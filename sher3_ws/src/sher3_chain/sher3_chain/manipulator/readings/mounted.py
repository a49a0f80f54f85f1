"""An arm that hangs otherwise than its model stands: on a wall, from a ceiling, or on a slope.

A drawing stands upright, a robot is screwed to whatever there is. The force of a joint is linear in gravity, so that
three numbers say which way it pulls in the frame of the base, the same for all joints; nothing else turns the weights
of all of them at once. Taken joint by joint they look like springs, cables and wrong weights.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_chain.manipulator.description import ManipulatorDescription
from sher3_chain.manipulator.model import ArmModel
from sher3_chain.manipulator.readings.senses import CLEARER, thinned
from sher3_chain.manipulator.view import MotionView
from sher3_chain.thresholds import CONFOUNDED

LEANS = np.deg2rad(10.0)
"""Angle from which an arm hangs otherwise than its model, rad: no floor slopes so much, and no wrong weight of a link
turns all weights by it."""
SIZES = (0.5, 2.0)
"""Found gravity over that of the earth, between which it is one: weights of a rough model are wrong by less."""
ROUNDS = 4
"""Rounds in which what is left of each joint is its weight."""
UNKNOWNS = 7
"""Numbers that are fitted to a joint: four of its own and gravity. A joint that hardly moves has no more samples."""


def mounted(
    views: Sequence[MotionView], described: ManipulatorDescription, model: ArmModel, judged: Collection[str]
) -> Array | None:
    """Return the gravity (3,), m/s^2, in the frame of the model's base that explains the efforts far better.

    None where that of the model does, where gravity is stated, or where no gain is: the unit of an effort then hides
    the size of a weight.

    Args:
        views: of all records, with the forces of the model in newton metres.
        described: the arm.
        model: of its rigid bodies.
        judged: joints with a usable effort.
    """
    rows = [i for i, j in enumerate(described.joints) if j.name in judged and isinstance(j.gain, float)]
    size = float(np.linalg.norm(model.tree.gravity))
    if described.gravity is not None or described.coupling is not None or described.inertias != "nominal":
        return None
    if model.losses is not None or not rows or not size:
        return None
    q, v, a, effort, judged = thinned(views)
    weightless = replace(model, tree=replace(model.tree, gravity=np.zeros(3)))
    free = weightless.needed(q, v, a)
    pulls = [replace(model, tree=replace(model.tree, gravity=g)).weight(q) for g in np.eye(3)]
    each = [np.column_stack([effort[:, i] - free[:, i], *(x[:, i] for x in pulls)]) for i in rows]
    joints = [
        _beside_own(v[judged[:, i], i], a[judged[:, i], i], x[judged[:, i]]) for i, x in zip(rows, each, strict=True)
    ]
    joints = [x for x in joints if len(x) > UNKNOWNS and np.any(x[:, 0])]
    if not joints:
        return None
    found = _pull(joints, model.tree.gravity)
    direction = found / max(float(np.linalg.norm(found)), np.finfo(float).tiny)
    lean = float(np.arccos(np.clip(direction @ model.tree.gravity / size, -1.0, 1.0)))
    if not SIZES[0] < np.linalg.norm(found) / size < SIZES[1] or lean < LEANS:
        return None
    new = size * direction
    left = effort - free - np.einsum("kni,k->ni", np.array(pulls), new)
    gives_energy = sum(float(np.sign(np.sum((v * left)[judged[:, i], i]))) for i in rows) < 0.0
    clearer = _log_residual_share(joints, model.tree.gravity) - _log_residual_share(joints, new) > CLEARER
    return new if clearer and not gives_energy else None


def _beside_own(v: Array, a: Array, x: Array) -> Array:
    """Return columns (n, 4) less what friction, a rotor and a constant force of the joint make of them."""
    own = np.column_stack([v, np.sign(v), a, np.ones_like(v)])
    return np.asarray(x - own @ np.linalg.lstsq(own, x, rcond=None)[0])


def _pull(joints: Sequence[Array], modelled: Array) -> Array:
    """Return the gravity (3,) by least squares of all joints, each over what is left of it.

    What no joint feels, as joints that are all upright do not feel what pulls along them, follows from the size of
    gravity; its sign is the model's.
    """
    sizes = [float(np.std(x[:, 0])) for x in joints]
    left, found, felt = sizes, np.zeros(3), np.eye(3)
    for _ in range(ROUNDS):
        stacked = np.concatenate([x / rest for rest, x in zip(left, joints, strict=True)])
        values, vectors = np.linalg.svd(stacked[:, 1:], full_matrices=False)[1:]
        felt = vectors[values > CONFOUNDED * values[0]]
        found = felt.T @ np.linalg.lstsq(stacked[:, 1:] @ felt.T, stacked[:, 0], rcond=None)[0]
        each = zip(sizes, joints, strict=True)
        left = [max(float(np.std(x[:, 0] - x[:, 1:] @ found)), 1e-6 * size) for size, x in each]
    unfelt = modelled - felt.T @ (felt @ modelled)
    hidden = np.sqrt(max(0.0, float(modelled @ modelled - found @ found)))
    return np.asarray(found + hidden * unfelt / max(float(np.linalg.norm(unfelt)), np.finfo(float).tiny))


def _log_residual_share(joints: Sequence[Array], gravity: Array) -> float:
    """Return the log of the share that a gravity leaves of the efforts, summed over the joints."""
    rest = [x[:, 0] - x[:, 1:] @ gravity for x in joints]
    shares = [np.mean(r**2) / np.mean(x[:, 0] ** 2) for r, x in zip(rest, joints, strict=True)]
    return float(np.sum(np.log(np.maximum(shares, np.finfo(float).tiny))))
