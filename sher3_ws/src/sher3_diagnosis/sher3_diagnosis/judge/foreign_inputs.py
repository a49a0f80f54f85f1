"""Whether inputs that no cause may depend on predict what the causes leave: then another law is at work.

A remainder that follows a cause's own inputs is the shape of its law. One that follows other quantities of the same
place, predicted for parts of the record that were not looked at, belongs to a law that the library does not have; the
causes stand in for it. How much of a gap that is, is told as a share of its size: a law off by a few per cent is one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.judge.evidence.cause import Felt, free_laws, inputs_of, whitened
from sher3_diagnosis.quantify.closure import residual_after


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
    left = residual_after(evidence, attribution.fit, channel)
    if not left or not all(isinstance(evidence.views[r], Felt) for r in left):
        return None
    bare = whitened(evidence, channel, residual_after(evidence, evidence.null(), channel))
    white = float(np.mean(whitened(evidence, channel, left) ** 2))
    own, _, other = free_laws(evidence, channel, inputs_of(attribution, channel), left)
    return Foreign(float(np.mean(bare**2)), white, white - own, white - other)
