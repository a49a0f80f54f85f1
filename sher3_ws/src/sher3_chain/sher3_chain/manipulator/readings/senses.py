"""Joints that a record counts in the other sense than the model: found by what the model then explains of the efforts.

A drawing and a controller often disagree on which way a joint turns. Place and effort of such a joint have the other
sign, its friction looks right, and weight and coupling of the joints beside it do not. Single joints and pairs are
tried the other way round, since one of two that carry each other explains little alone; they are turned where the
model explains the efforts of the arm far better so. Where all of an arm mirrors, nothing tells its two pictures apart,
and the one with fewer joints turned is taken.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
from sher3_diagnosis.channel import Array, Mask

from sher3_chain.joint.record import AxesRun
from sher3_chain.manipulator.description import ManipulatorDescription
from sher3_chain.manipulator.model import ArmModel
from sher3_chain.manipulator.view import MotionView

POSTURES = 150
"""Samples of all records at which the senses are compared."""
CLEARER = 2.0 * np.log(4.0)
"""Fall of the log variance that the model leaves, over all joints, from which a joint is turned: half the rms of two
joints, or a quarter of that of one. No error of a drawing does that by chance."""
ALIKE = 0.5
"""Difference of two such logs that is none: mirrored pictures of one arm differ by their friction alone."""
TURNED = ("position", "reference", "effort", "command", "load", "applied", "nominal_effort")
"""Signals of a joint that have the other sign."""


def against_model(
    views: Sequence[MotionView], described: ManipulatorDescription, model: ArmModel, judged: Collection[str]
) -> tuple[str, ...]:
    """Return the joints that the records count in the other sense than the model does.

    Args:
        views: of all records, with the forces of the model in newton metres.
        described: the arm.
        model: of its rigid bodies.
        judged: joints with a usable effort.
    """
    rows = [i for i, joint in enumerate(described.joints) if joint.name in judged]
    stated = [isinstance(joint.gain, float) for joint in described.joints]
    if described.coupling is not None or described.inertias != "nominal" or not rows:
        return ()
    q, v, a, effort, judged_at = thinned(views)
    rows = [i for i in rows if effort[judged_at[:, i], i].any()]
    if not rows or not v.any():
        return ()

    def left(senses: Array) -> float:
        needed = model.needed(senses * q, senses * v, senses * a)
        return sum(
            _log_residual_share(needed[ok, i], senses[i] * v[ok, i], senses[i] * effort[ok, i], stated[i])
            for i, ok in zip(rows, judged_at[:, rows].T, strict=True)
        )

    k = len(described.joints)
    senses, best = np.ones(k), left(np.ones(k))
    some = [np.isin(np.arange(k), turn) for number in (1, 2) for turn in combinations(range(k), number)]
    for _ in rows:
        found = np.array([left(np.where(turn, -senses, senses)) for turn in some])
        if best - found.min() < CLEARER:
            break
        i = int(np.flatnonzero(found < found.min() + ALIKE)[0])  # of mirrored ones that with fewer joints
        best, senses = float(found[i]), np.where(some[i], -senses, senses)
    return tuple(joint.name for joint, sense in zip(described.joints, senses, strict=True) if sense < 0.0)


def turned(run: AxesRun, joints: Collection[str]) -> AxesRun:
    """Return a record with the signals of some joints in the other sense."""
    signals = {
        joint: {name: -x if joint in joints and name in TURNED else x for name, x in found.items()}
        for joint, found in run.signals.items()
    }
    return replace(run, signals=signals)


def thinned(views: Sequence[MotionView]) -> tuple[Array, Array, Array, Array, Mask]:
    """Return position, velocity, acceleration and effort at some samples of the inner parts of all records, and where
    the effort of a joint says something, (n, k) each: at rest friction and brakes take any value.
    """
    parts = []
    for view in views:
        inner = np.flatnonzero(view.run.inner)
        at = inner[:: max(1, len(inner) * len(views) // POSTURES)]
        judged = np.column_stack([view.in_motion(row)[at] for row in range(len(view.joints))])
        parts.append((view.position[at], view.velocity[at], view.acceleration[at], view.effort[at], judged))
    q, v, a, effort, judged = (np.concatenate(x) for x in zip(*parts, strict=True))
    return q, v, a, effort, judged


def _log_residual_share(needed: Array, v: Array, effort: Array, stated: bool) -> float:
    """Return the log of the share of an effort (n,) that the model and friction leave; its sign and unit are free.

    Only the sign is, where the gain is stated. There is no constant: weight tells the sense of a joint that lifts.
    """
    friction = np.column_stack([v, np.sign(v)])
    if not stated:
        columns, targets = np.column_stack([needed, friction]), [effort]
    else:
        columns, targets = friction, [effort - needed, effort + needed]
    rest = [y - columns @ np.linalg.lstsq(columns, y, rcond=None)[0] for y in targets]
    tiny = np.finfo(float).tiny
    return float(np.log(max(min(np.mean(x**2) for x in rest), tiny) / max(np.mean(effort**2), tiny)))
