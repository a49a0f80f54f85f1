"""What an axis at rest tells: a force that no cause accounts for is held by dry friction, or causes are wrong.

The force balance at rest is an inequality and no part of the fits; it decides between sets of causes that motion in one
direction alone cannot tell apart (a constant force and a constant friction).
"""

from __future__ import annotations

import numpy as np

from sher3_gap.channels import Channel
from sher3_gap.fitting import Fit
from sher3_gap.machines.axis_evidence import AxisEvidence
from sher3_gap.machines.effects import DRY

STATIC = 1.5
"""Friction at rest over friction in motion, at most."""


def rest_loss(evidence: AxisEvidence, fit: Fit) -> float:
    """Squares over the floor of what causes leave at rest beyond what dry friction holds; 0 for a servo."""
    axis = evidence.axis
    channel = Channel("motor_mechanics", axis.name)
    if axis.command_law.kind == "position" or not evidence.mass:
        return 0.0
    hold = sum(abs(float(fit.of(i)[0])) for i, t in enumerate(fit.terms) if t.effect.id in DRY)
    loss = 0.0
    for view in evidence.records:
        rest = view.at_rest
        floor = next(
            (f[channel] for v, f in zip(evidence.views, evidence.floors, strict=True) if v is view and channel in f),
            None,
        )
        if floor is None or view.run.effort is None or not rest.any():
            continue
        left = (view.run.to_grid(view.run.effort) - view.path.gravity)[:, 0]
        for i, term in enumerate(fit.terms):
            if term.effect.id not in DRY:
                added = term.effect.signature(view, term.site, term.shape)
                if channel in added.columns:
                    left = left - added.columns[channel][:, 0] @ fit.of(i)
        beyond = np.maximum(np.abs(left[rest]) - STATIC * hold, 0.0)
        loss += float(np.sum((np.maximum(beyond - 2.0 * floor[0], 0.0) / floor[0]) ** 2))
    return loss
