"""Stepwise growth of a fit by many small errors of one kind, such as the geometric errors of a serial arm.

The search for causes asks how much of a gap each cause explains. Forty errors of a few hundredths of a millimetre each
explain little alone and everything together, so here the price of a number decides.
"""

from __future__ import annotations

from collections.abc import Sequence

from sher3_common.progress import Say

from sher3_diagnosis.attribute.candidates import Candidates, complexity
from sher3_diagnosis.attribute.rivals import Attribution, pruned_by, without_term
from sher3_diagnosis.attribute.search import Left
from sher3_diagnosis.attribute.ties import first_of_least
from sher3_diagnosis.effect import Effect, within
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.thresholds import NEEDED, PARSIMONY, PRICE


def layers(effects: Sequence[Effect]) -> list[list[Effect]]:
    """Return effects in the order they are looked for: what a plain one explains is not blamed on the others."""
    return [[e for e in effects if e.plain], [e for e in effects if not e.plain]]


def layered(candidates: Candidates, left_over: Left, say: Say) -> Attribution:
    """Grow the fit layer by layer where there is a gap.

    Rivals are not named: each of many small errors could be another one's at its neighbour.
    """
    current = candidates.evidence.null()
    steps = [current]
    for layer in layers(candidates.effects) if left_over(current) else ():
        say(f"fitting {', '.join(e.id for e in layer)}")
        current = grow(candidates, layer, current)
        steps.append(current)
    terms = range(len(current.terms))
    explained = tuple(without_term(candidates.evidence, current, i).total - current.total for i in terms)
    rivals: tuple[tuple[()], ...] = tuple(() for _ in terms)
    nuisance = len(candidates.evidence.nuisance)
    return Attribution(current, rivals=rivals, explained=explained, nuisance=nuisance, steps=tuple(steps))


def grow(candidates: Candidates, effects: Sequence[Effect], current: Fit) -> Fit:
    """Add the error that lowers the held-out loss most while it pays its price, then drop those that no longer pay.

    Args:
        candidates: the evidence, and the sites effects may sit on.
        effects: that may be added, at every site, in one of the shapes they try.
        current: to be grown; terms it has are kept while they are worth their price.
    """
    evidence = candidates.evidence
    base = evidence.null().total
    left = [candidates.term(e, site, shape) for e in effects for site in candidates.sites(e) for shape in e.tried]
    while left:
        trials = [fit(evidence.data, [*current.terms, t]) for t in left]
        costs = {i: trials[i].total + PRICE * complexity(t) for i, t in enumerate(left) if _within_limits(trials[i])}
        if not costs:
            break
        cheapest = first_of_least(costs)
        if current.total - trials[cheapest].total < _needed(left[cheapest], base, current):
            break
        current, taken = trials[cheapest], left[cheapest]
        left = [t for t in left if (t.effect, t.site) != (taken.effect, taken.site)]

    def worth(now: Fit, i: int, without: Fit) -> bool:
        return without.total - now.total > _needed(now.terms[i], base, now)

    return pruned_by(evidence, current, worth)


def _within_limits(trial: Fit) -> bool:
    """Return whether the numbers of the last term may be what its page says that they are."""
    term, found = trial.terms[-1], trial.of(len(trial.terms) - 1)
    values = term.effect.parameters(term.shape, found)
    return within(term.effect.limits(term.shape), {name: (x,) for name, x in values.items()})


def _needed(term: Term, base: float, current: Fit) -> float:
    """Held-out loss that a term must be worth."""
    return NEEDED * complexity(term) + PARSIMONY * (base - current.total)
