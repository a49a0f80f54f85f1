"""Stepwise growth of a fit by many small errors of one kind, such as the geometric errors of a serial arm.

The search for causes asks how much of a gap each cause explains. Forty errors of a few hundredths of a millimetre each
explain little alone and everything together, so here the price of a number decides.
"""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.attribute.candidates import Candidates, complexity
from sher3_diagnosis.attribute.rivals import without_term
from sher3_diagnosis.attribute.ties import first_of_least
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.thresholds import NEEDED, PARSIMONY, PRICE


def grow(candidates: Candidates, effects: Sequence[Effect], current: Fit) -> Fit:
    """Add the error that lowers the held-out loss most while it pays its price, then drop those that no longer pay.

    Args:
        candidates: the evidence, and the sites effects may sit on.
        effects: that may be added, at every site.
        current: to be grown; terms it has are kept while they are worth their price.
    """
    evidence = candidates.evidence
    base = evidence.null().total
    left = [candidates.term(e, site, {}) for e in effects for site in candidates.sites(e)]
    while left:
        trials = [fit(evidence.data, [*current.terms, t]) for t in left]
        cheapest = first_of_least({i: trials[i].total + PRICE * complexity(t) for i, t in enumerate(left)})
        if current.total - trials[cheapest].total < _needed(left[cheapest], base, current):
            break
        current = trials[cheapest]
        left.pop(cheapest)
    return _prune(evidence, current, base)


def _needed(term: Term, base: float, current: Fit) -> float:
    """Held-out loss that a term must be worth."""
    return NEEDED * complexity(term) + PARSIMONY * (base - current.total)


def _prune(evidence: Evidence, current: Fit, base: float) -> Fit:
    first = len(evidence.nuisance)
    while len(current.terms) > first + 1:
        reduced = {i: without_term(evidence, current, i) for i in range(first, len(current.terms))}
        least = first_of_least({i: reduced[i].total for i in sorted(reduced, reverse=True)})
        if reduced[least].total - current.total > _needed(current.terms[least], base, current):
            break
        current = reduced[least]
    return current
