"""How probable each answer to an item is: an effect of the library, something outside it, or no gap of its own."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from sher3_diagnosis.finding import ExactFinding
from sher3_diagnosis.judge.calibration.calibration import Calibration
from sher3_diagnosis.judge.costs import LIBRARY, NO_GAP, OUTSIDE
from sher3_diagnosis.judge.evidence.scales import scaled_cause, scaled_exact, scaled_gap
from sher3_diagnosis.judge.items import Item
from sher3_diagnosis.verdict import Interval


@dataclass(frozen=True)
class Judged:
    """An item with its probabilities, which add up to one.

    Attributes:
        item: what was judged.
        effects: per candidate of the item, the probability that it is the cause.
        outside: that the cause is none of the library.
        no_gap: that the item is no gap, or no cause, of its own.
        closure: of a cause; None of a gap without one.
    """

    item: Item
    effects: Sequence[float]
    outside: float
    no_gap: float
    closure: Interval | None = None

    @property
    def library(self) -> float:
        """Probability that the true effect is among the candidates."""
        return float(sum(self.effects))

    @property
    def odds(self) -> dict[str, float]:
        """Probabilities of library, outside and no gap."""
        return {LIBRARY: self.library, OUTSIDE: self.outside, NO_GAP: self.no_gap}


def judged(item: Item, calibration: Calibration, closure: Interval | None = None) -> Judged:
    """Return an item with its probabilities and, of a cause, its closure."""
    if item.index is None:
        found = calibration.gap.probabilities(scaled_gap(item.numbers))
        return Judged(item, (), found[OUTSIDE], found[NO_GAP])
    found = calibration.cause.probabilities(scaled_cause(item.numbers))
    far = np.array([c.unlikeness for c in item.candidates])
    shares = np.exp(-calibration.sharpness * (far - far.min()))
    effects = found[LIBRARY] * shares / shares.sum()
    return Judged(item, tuple(effects.tolist()), found[OUTSIDE], found[NO_GAP], closure)


def reproduced(stage: ExactFinding, calibration: Calibration) -> float:
    """Return the probability that the causes of an exact stage are those at work; 0 without one."""
    if not stage.causes:
        return 0.0
    return calibration.exact.probabilities(scaled_exact(stage.closure.value))[LIBRARY]


def probabilities_of(
    items: Iterable[Judged], exact: Iterable[ExactFinding], calibration: Calibration
) -> dict[str, float]:
    """Return answer -> probability, the sum of which is the number of items: one for each cause and each gap."""
    out: dict[str, float] = defaultdict(float)
    for j in items:
        for candidate, p in zip(j.item.candidates, j.effects, strict=False):
            out[f"{candidate.effect}:{candidate.site}"] += p
        out[OUTSIDE] += j.outside
        out[NO_GAP] += j.no_gap
    for stage in exact:
        known = reproduced(stage, calibration)
        for cause in stage.causes:
            out[f"{cause.effect}:{cause.actuator}"] += known / len(stage.causes)
        out[OUTSIDE] += 1.0 - known
    return {name: p for name, p in sorted(out.items(), key=lambda x: -x[1]) if p >= LEAST}


LEAST = 5e-4
"""Probability below which an answer is not listed."""
