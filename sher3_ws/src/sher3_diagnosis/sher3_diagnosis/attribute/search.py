"""Which effects explain the gaps: forward selection with pairs, a backward pass, and the rivals of each cause.

All comparisons are of held-out loss (every run scored with coefficients fitted to the others), in units of the floor.
"""

from __future__ import annotations

from itertools import combinations

from sher3_common.progress import Say

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.constancy import constancy_of
from sher3_diagnosis.attribute.rivals import RANKED, Attribution, with_rivals
from sher3_diagnosis.attribute.ties import TIE
from sher3_diagnosis.attribute.together import Left as Left
from sher3_diagnosis.attribute.together import pruned
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.thresholds import (
    COMPLETE,
    MAX_CAUSES,
    PAIR_GAIN,
    PAIR_WORTH,
    WORTH,
)


def attribute(
    candidates: Candidates, left_over: Left, say: Say, causes: int = MAX_CAUSES, start: Fit | None = None
) -> Attribution:
    """Select causes until no gap is left that an effect explains.

    Args:
        candidates: the evidence and the effects that may explain it.
        left_over: says which gaps are left under a fit.
        say: progress.
        causes: named at most, beside those of the start.
        start: fit from which the selection goes on; default the one without causes.
    """
    evidence = candidates.evidence
    current = evidence.null() if start is None else start
    chosen = list(current.terms)
    most = len(chosen) + causes
    while len(chosen) < most:
        left = left_over(current)
        if not left:
            break
        say(f"explaining {', '.join(map(str, sorted(left)))}")
        step = _step(candidates, current, chosen, left, most)
        if step is None:
            break
        current = step
        chosen = list(current.terms)
    current = pruned(evidence, current, left_over, relative=start is not None)
    found = with_rivals(candidates, current)
    steady = _more_constant(evidence, found)
    return found if steady is None else with_rivals(candidates, steady)


def _gain(evidence: Evidence, before: Fit, after: Fit, left: dict[Channel, float]) -> float:
    """Largest share of a remaining gap that a fit explains."""
    best = 0.0
    for channel, excess in left.items():
        best = max(best, (evidence.loss(channel, before) - evidence.loss(channel, after)) / excess)
    return best


def _step(
    candidates: Candidates, current: Fit, chosen: list[Term], left: dict[Channel, float], most: int
) -> Fit | None:
    found = candidates.search(left, chosen)
    if not found:
        return None
    best = found[0]
    gain = _gain(candidates.evidence, current, best, left)
    if gain < COMPLETE and len(chosen) + 2 <= most:
        pair = _pair(candidates, current, chosen, found[:RANKED], left)
        if pair is not None and _gain(candidates.evidence, current, pair, left) > max(gain + PAIR_GAIN, PAIR_WORTH):
            return pair
    if gain < WORTH:
        return None
    return best


def _pair(
    candidates: Candidates, current: Fit, chosen: list[Term], found: list[Fit], left: dict[Channel, float]
) -> Fit | None:
    best: Fit | None = None
    for a, b in combinations([f.terms[-1] for f in found], 2):
        if a.key == b.key or not a.channels & b.channels:
            continue
        trial = fit(candidates.evidence.data, [*chosen, a, b])
        if trial.admissible and (best is None or trial.total < best.total - TIE):
            best = trial
    return best


def _more_constant(evidence: Evidence, found: Attribution) -> Fit | None:
    """Where a cause changes size between excitations and a rival does not, the fit with that rival in its place."""
    for i in found.causes:
        if constancy_of(evidence, found.fit, i).constant:
            continue
        for rival in found.rivals[i]:
            terms = [*found.fit.terms[:i], rival.terms[-1], *found.fit.terms[i + 1 :]]
            trial = fit(evidence.data, terms)
            if trial.admissible and constancy_of(evidence, trial, i).constant:
                return trial
    return None
