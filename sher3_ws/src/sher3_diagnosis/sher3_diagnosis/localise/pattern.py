"""Whether a gap lives where its cause says it does: predicted against realised reduction of loss, regime by regime.

With p what a cause adds to a residual y that is rid of the other causes, and coefficients of the other runs, adding it
takes y^2 - (y - p)^2 off the loss. Where the cause is right this is p^2 on average, in every regime; a stand-in takes
as much off in all as it promises (least squares see to that), but in other places.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.localise.regimes import regime_masks


@dataclass(frozen=True)
class Share:
    """One regime's share of a cause's reduction of held-out loss, predicted and realised."""

    family: str
    regime: str
    predicted: float
    realised: float


@dataclass(frozen=True)
class Pattern:
    """How well the places of a gap agree with its cause.

    Attributes:
        shares: of every regime, by family.
        mismatch: per family, half the sum of the differences of the shares: 0 where they agree, 1 where they are apart.
    """

    shares: tuple[Share, ...]
    mismatch: dict[str, float]

    @property
    def agreement(self) -> float:
        """One less the largest mismatch; 1 where there is nothing to compare."""
        return 1.0 - max(self.mismatch.values(), default=0.0)

    @property
    def worst(self) -> Share | None:
        """The regime whose shares differ most."""
        return max(self.shares, key=lambda s: abs(s.realised - s.predicted), default=None)


def pattern_of(evidence: Evidence, fit: Fit, index: int) -> Pattern:
    """Compare where a cause predicts the gap with where held-out runs lose it, regime by regime."""
    sums: dict[tuple[str, str], Array] = defaultdict(lambda: np.zeros(2))
    for run in range(len(evidence.views)):
        for channel in fit.terms[index].channels & evidence.data.target[run].keys():
            added, without = _parts(evidence, fit, index, run, channel)
            realised, predicted = _by_sample(without**2 - (without - added) ** 2, added**2, evidence, run, channel)
            ok = evidence.data.residuals[run][channel].ok
            for family, members in regime_masks(evidence, run, channel.actuator).items():
                for name, mask in members.items():
                    sums[family, name] += (predicted[mask[ok]].sum(), realised[mask[ok]].sum())
    return _compared(sums)


def _parts(evidence: Evidence, fit: Fit, index: int, run: int, channel: Channel) -> tuple[Array, Array]:
    """What the cause adds to a channel of a held-out run, and the residual less the other causes, standardised (N,)."""
    target = evidence.data.target[run][channel]
    parts = [term.adds(run, channel, fit.loro_of(j)[run]) for j, term in enumerate(fit.terms)]
    added = np.broadcast_to(parts.pop(index), target.shape)
    return added, target - sum(parts)


def _by_sample(
    realised: Array, predicted: Array, evidence: Evidence, run: int, channel: Channel
) -> tuple[Array, Array]:
    """Sum the components of each sample, (n,)."""
    width = len(evidence.floors[run][channel])
    return realised.reshape(-1, width).sum(axis=1), predicted.reshape(-1, width).sum(axis=1)


def _compared(sums: dict[tuple[str, str], Array]) -> Pattern:
    shares, mismatch = [], {}
    for family in dict.fromkeys(f for f, _ in sums):
        members = {name: pair for (f, name), pair in sums.items() if f == family}
        total = np.sum(list(members.values()), axis=0)
        if len(members) < 2 or total.min() <= 0.0:
            continue
        parts = {name: pair / total for name, pair in members.items()}
        shares += [Share(family, name, float(p), float(r)) for name, (p, r) in parts.items()]
        mismatch[family] = 0.5 * float(sum(abs(r - p) for p, r in parts.values()))
    return Pattern(tuple(shares), mismatch)
