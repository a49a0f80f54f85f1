"""How far an arm is off, in words."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.quantify.closure import residual_after

from sher3_static.arm.view import ArmView
from sher3_static.table import TableEvidence
from sher3_static.thresholds import WORST

MM = 1e3
"""Millimetres in a metre."""


def held_out(evidence: TableEvidence, after: Fit) -> Array:
    """Return the errors (n, 3) of positions or (n, 1) of lengths, m, under coefficients fitted to the other folds."""
    return np.concatenate([x[:, :3] for x in residual_after(evidence, after, evidence.table.channel).values()])


def fitted_errors(evidence: TableEvidence, after: Fit) -> Array:
    """Return the errors (n, 3) or (n, 1), m, under coefficients fitted to all postures."""
    channel, floor = evidence.table.channel, evidence.table.floor
    out = []
    for r, target in enumerate(evidence.data.target):
        columns = np.hstack([t.columns[r][channel] for t in after.terms])
        out.append((target[channel] - columns @ after.coefficients).reshape(-1, len(floor)) * floor)
    return np.concatenate(out)[:, :3]


def errors_in_words(evidence: TableEvidence, after: Fit) -> str:
    """Return the error under a fit, of held-out postures and of those fitted."""
    view = evidence.table.view
    assert isinstance(view, ArmView)
    held, fitted = (MM * np.linalg.norm(x(evidence, after), axis=1) for x in (held_out, fitted_errors))
    text = f"{view.sight.what} error on held-out postures {held.mean():.2f} mm mean, {held.max():.1f} mm worst"
    return f"{text} ({fitted.mean():.2f} mm on those fitted)"


def worst_postures(evidence: TableEvidence, after: Fit) -> str:
    """Return how much of what is left the worst postures hold: a few bad measurements, or all of the workspace."""
    square = np.sort(np.sum(held_out(evidence, after) ** 2, axis=1))
    worst = float(square[-max(1, len(square) // WORST) :].sum() / square.sum())
    mean = MM * float(np.sqrt(square).mean())
    return f"{mean:.2f} mm mean left; the worst {1 / WORST:.0%} of the postures hold {worst:.0%} of its power"
