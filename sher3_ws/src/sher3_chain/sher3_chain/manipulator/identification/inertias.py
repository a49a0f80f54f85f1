"""Inertial parameters found from the data, beside the usual friction of every joint.

Inverse-dynamics identification (Gautier and Khalil; Janot et al.): efforts = regressor * parameters + friction, all
joints together. What the motion does not tell stays as the model has it: the step from the model's parameters is the
shortest one that explains the efforts, which changes base parameters alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sher3_chain.manipulator.identification.gains import friction_columns
from sher3_chain.manipulator.model import ArmModel
from sher3_chain.manipulator.view import MotionView

UNSEEN = 1e-3
"""Singular value, as a share of the largest, below which the motion does not determine a combination of parameters."""


def with_identified_inertias(views: Sequence[MotionView], model: ArmModel, judged: Sequence[str]) -> ArmModel:
    """Return the model with the inertial parameters that explain the efforts of all joints best.

    Args:
        views: of all records.
        model: nominal.
        judged: joints whose effort was recorded.
    """
    rows, target = [], []
    scales = [_spread(views, joint) for joint in judged]
    for view in views:
        for place, (joint, scale) in enumerate(zip(judged, scales, strict=True)):
            row, ok = view.row(joint), view.in_motion(view.row(joint))
            friction = friction_columns(view, joint)[ok, :2]  # a constant force would take the weight
            own = np.zeros((int(ok.sum()), len(judged) * friction.shape[1]))
            own[:, place * friction.shape[1] : (place + 1) * friction.shape[1]] = friction
            rows.append(np.hstack([view.regressor[ok, row], own]) / scale)
            target.append((view.effort[ok, row] - view.rigid[ok, row]) / scale)
    x, y = np.concatenate(rows), np.concatenate(target)
    length = np.linalg.norm(x, axis=0)
    alive = length > 0.0
    step = np.zeros(x.shape[1])
    step[alive] = np.linalg.lstsq(x[:, alive] / length[alive], y, rcond=UNSEEN)[0] / length[alive]
    return replace(model, parameters=model.inertial + step[: len(model.inertial)])


def _spread(views: Sequence[MotionView], joint: str) -> float:
    """Return the standard deviation of a joint's effort over all records: what it errs by differs by joint alone.

    Records are not brought to one size: near a resonance inertia and weight cancel, and a small effort is their error.
    """
    found = [view.effort[view.in_motion(view.row(joint)), view.row(joint)] for view in views]
    return max(float(np.std(np.concatenate(found))), np.finfo(float).tiny)
