"""What an axis at rest tells: a force that no cause accounts for is held by dry friction, or the causes are wrong.

The force balance at rest is an inequality and no part of the fits. It decides between sets of causes that motion in one
direction alone cannot tell apart, such as a constant force and a constant friction.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.thresholds import NEEDED

from sher3_chain.axes.view import AxisView
from sher3_chain.thresholds import REST_FLOORS, STATIC


def rest_loss(evidence: Any, fit: Fit) -> float:
    """Return the squares over the floor of what causes leave at rest beyond what dry friction holds; 0 for a servo."""
    axis = evidence.axis
    channel = Channel("motor_mechanics", axis.name)
    if axis.servo or not evidence.mass:
        return 0.0
    holds = STATIC * sum(abs(float(fit.of(i)[0])) for i, t in enumerate(fit.terms) if t.effect.dry)
    floors = {id(v): f[channel][0] for v, f in zip(evidence.views, evidence.floors, strict=True) if channel in f}
    loss = 0.0
    for view in evidence.records:
        if id(view) in floors and view.at_rest.any():
            floor = floors[id(view)]
            beyond = np.abs(_residual_force(view, fit, channel)[view.at_rest]) - holds - REST_FLOORS * floor
            loss += float(np.sum((np.maximum(beyond, 0.0) / floor) ** 2))
    return loss


def _residual_force(view: AxisView, fit: Fit, channel: Channel) -> Array:
    """Force (g,) that weight and the causes other than dry friction leave of the measured one."""
    assert view.run.effort is not None
    left = (view.run.to_grid(view.run.effort) - view.path.gravity)[:, 0]
    for i, term in enumerate(fit.terms):
        if not term.effect.dry:
            added = term.effect.signature(view, term.site, term.shape).columns
            if channel in added:
                left = left - added[channel][:, 0] @ fit.of(i)
    return left


def rivals_at_rest(evidence: Any, found: Attribution) -> Attribution:
    """Return the causes with the rivals that leave no more at rest than they do: what motion cannot tell, rest may."""
    most = rest_loss(evidence, found.fit) + NEEDED
    kept = tuple(tuple(f for f in rivals if rest_loss(evidence, f) < most) for rivals in found.rivals)
    return replace(found, rivals=kept)
