"""Whether inputs that no cause may depend on predict what the causes leave: then another law is at work.

A remainder that follows a cause's own inputs is the shape of its law. One that follows other quantities of the same
place, predicted for parts of the record that were not looked at, belongs to a law that the library does not have; the
causes stand in for it. How much of a gap that is, is told as a share of its size: a law off by a few per cent is one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.judge.evidence.free_law import ROWS, loss_left
from sher3_diagnosis.quantify.closure import residual_after

OF_FAMILY: Mapping[str, tuple[str, ...]] = {"friction": ("direction", "velocity")}
"""Inputs that the laws of a family share, whichever was chosen: any friction may rise or fall with the speed."""


@dataclass(frozen=True)
class Foreign:
    """By how much free laws reduce a residual: mean squares per sample, in squares of the floor.

    Attributes:
        gap: what there is without any cause.
        left: what the causes leave.
        own: what is left of it by a free function of the causes' own inputs.
        other: what is left of that by one of all quantities of the place.
    """

    gap: float
    left: float
    own: float
    other: float

    @property
    def size(self) -> float:
        """Size of the part that only other quantities predict, over that of the gap."""
        return float(np.sqrt(max(self.own - self.other, 0.0) / self.gap))

    @property
    def share(self) -> float:
        """Share of what the cause's own inputs leave above the floor that other quantities predict."""
        return (self.own - self.other) / max(self.own - 1.0, 1e-9)


def foreign_in(evidence: Evidence, attribution: Attribution, channel: Channel) -> Foreign | None:
    """Return how well other inputs predict a residual; None where a view lacks the quantities of its place."""
    terms = [attribution.fit.terms[i] for i in attribution.causes if channel in attribution.fit.terms[i].channels]
    left = residual_after(evidence, attribution.fit, channel)
    if not terms or not left or not all(hasattr(evidence.views[r], "quantities") for r in left):
        return None
    inputs = {x for term in terms for x in (*term.effect.inputs, *OF_FAMILY.get(term.effect.family, ()))}
    own, other, signal, before, run = [], [], [], [], []
    bare = residual_after(evidence, evidence.null(), channel)
    step = max(1, sum(map(len, left.values())) // ROWS)
    for r, x in left.items():
        rows = np.flatnonzero(evidence.data.residuals[r][channel].ok)[::step]
        known: Mapping[str, Array] = evidence.views[r].quantities(channel.actuator)  # type: ignore[attr-defined]
        own.append(_stacked({n: c for n, c in known.items() if n in inputs}, rows))
        other.append(_stacked({n: c for n, c in known.items() if n not in inputs}, rows))
        floor = evidence.floors[r][channel]
        signal.append(x[::step] / floor)
        before.append(bare[r][::step] / floor)
        run.append(np.full(len(rows), r))
    y = np.concatenate(signal)
    losses = loss_left([np.vstack(own), np.vstack(other)], y, np.concatenate(run))
    return Foreign(float(np.mean(np.concatenate(before) ** 2)), float(np.mean(y**2)), losses[0], losses[1])


def _stacked(columns: Mapping[str, Array], rows: NDArray[np.int64]) -> Array:
    parts = [np.asarray(x)[rows] for x in columns.values()]
    return np.hstack(parts) if parts else np.zeros((len(rows), 0))
