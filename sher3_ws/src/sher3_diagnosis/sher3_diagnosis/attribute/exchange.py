"""Causes searched again beside the others: each was chosen before the later ones were there."""

from __future__ import annotations

from sher3_diagnosis.attribute.candidates import Candidates, complexity
from sher3_diagnosis.attribute.polish import polish
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.ties import TIE
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, fit
from sher3_diagnosis.thresholds import NEEDED, PRICE

ROUNDS = 4
"""Rounds over the causes at most: the second lets the first cause see the last one in its new shape."""


def exchanged(candidates: Candidates, found: Attribution) -> Fit:
    """Return the fit with every cause, or a rival at its place, searched again beside the others.

    The causes keep their order. A plainer law of the same family is tried at its best shape: a dead time between two
    that the search tries is one still, and no shorter one beside a lag.
    """
    best = found.fit
    for _ in range(ROUNDS):
        before = best
        for i in found.causes:
            term = best.terms[i]
            others = best.others(i)
            effects = [term.effect, *(f.terms[-1].effect for f in found.rivals[i] if f.terms[-1].site == term.site)]
            for effect in effects:
                trial = candidates.best(effect, term.site, others)
                if trial is None:
                    continue
                if effect.family == term.effect.family and complexity(trial.terms[-1]) < complexity(term):
                    trial = polish(candidates.evidence, trial, len(trial.terms) - 1)
                if _gain(candidates.evidence, best, i, trial) > TIE:
                    best = fit(candidates.evidence.data, [*others[:i], trial.terms[-1], *others[i:]])
        if best is before:
            break
    return best


def _gain(evidence: Evidence, best: Fit, index: int, trial: Fit) -> float:
    """Return what is won by the last law of `trial` in the place of one cause.

    A law of more numbers must be needed. One of fewer may lose their price; what lies below the floor is no loss.
    """
    more = complexity(trial.terms[-1]) - complexity(best.terms[index])
    if more < 0:
        return over_floor(evidence, best) - over_floor(evidence, trial) - PRICE * more
    return best.total - trial.total - NEEDED * more


def over_floor(evidence: Evidence, found: Fit) -> float:
    """Return the loss above the floor, channel by channel: what is spared in one pays for nothing in another."""
    return sum(max(0.0, loss - evidence.data.samples[key]) for key, loss in found.loss.items())
