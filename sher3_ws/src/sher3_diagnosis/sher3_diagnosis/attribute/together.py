"""All plain laws of a place fitted at once, then pruned by the loss on parts left out.

A search that takes one cause at a time gives the first one a part of the others: a dry friction takes a weight's, and
none of several alike explains enough of the gap alone. Together each has its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace

from sher3_diagnosis.attribute.candidates import Candidates, complexity, possible
from sher3_diagnosis.attribute.rivals import pruned_by, without_term
from sher3_diagnosis.attribute.ties import TIE, first_of_least
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.thresholds import NEEDED, OF_THE_REST, PARSIMONY

Left = Callable[[Fit], dict[Channel, float]]
"""Gaps that are left under a fit: channel -> excess loss."""
PASSES = 3
"""Rounds over the laws at most: each is searched again beside the others as they are by then."""


def together(candidates: Candidates, gaps: Collection[Channel], left_over: Left, beside: Sequence[Term] = ()) -> Fit:
    """Return the plain laws that are worth their numbers, fitted at once; the null fit where none is.

    Shapes are searched twice: beside all linear laws, whatever their signs, then beside those that are possible. Beside
    all of them a law that is not there comes out a little below zero as often as above; were that forbidden, a wrong
    delay that lifts it above zero would be taken.

    Args:
        candidates: the evidence and the effects, of which the plain ones are taken.
        gaps: channels of which at least one must show a law.
        left_over: says which gaps are left under a fit.
        beside: richer laws that they are fitted beside; the plain ones that these contain are left out.
    """
    laws = [(e, site) for e in candidates.effects if e.ordinary for site in candidates.sites(e)]
    laws = [(e, site) for e, site in laws if set(e.channels(site)) & set(gaps) and not _contained(e, site, beside)]
    every = _shaped(replace(candidates, possible=possible), laws, _linear(candidates, laws, beside))
    current = _shaped(candidates, laws, without_impossible(candidates.evidence, every))
    return pruned(candidates.evidence, current, left_over, relative=True)


def _shaped(candidates: Candidates, laws: list[tuple[Effect, str]], current: Fit) -> Fit:
    """Return a fit whose laws were searched again beside the others, in turn, while that explains more."""
    for _ in range(PASSES):
        before = current
        for effect, site in laws:
            others = [t for t in current.terms if t.key != (effect.id, site)]
            trial = candidates.best_plain(effect, site, others)
            if trial is not None and trial.total < current.total - TIE:
                current = trial
        if current is before:
            break
    return current


def _contained(effect: Effect, site: str, beside: Sequence[Term]) -> bool:
    return any(effect.id in t.effect.extends for t in beside if t.site == site)


def _linear(candidates: Candidates, laws: list[tuple[Effect, str]], beside: Sequence[Term]) -> Fit:
    """Return the laws that a coefficient of zero takes away, in their first shape; some may be impossible alone."""
    evidence = candidates.evidence
    shapes = [(e, site, next(iter(e.plain_shapes(evidence.views, site)), None)) for e, site in laws]
    terms = [candidates.term(e, site, shape) for e, site, shape in shapes if shape is not None]
    return fit(evidence.data, [*evidence.nuisance, *beside, *(t for t in terms if _vanishes(t))])


def without_impossible(evidence: Evidence, current: Fit) -> Fit:
    """Return a fit without impossible laws, removed one at a time, the law that explains least first."""
    while wrong := [i for i, t in enumerate(current.terms) if not t.effect.admissible(t.shape, current.of(i))]:
        reduced = {i: without_term(evidence, current, i) for i in wrong}
        current = reduced[first_of_least({i: f.total for i, f in reduced.items()})]
    return current


def _vanishes(term: Term) -> bool:
    return term.width > 0 and bool(term.channels) and not any(term.fixed)


def law_error(evidence: Evidence, current: Fit, plain: bool) -> float:
    """Return the held-out loss that laws are allowed to be off by.

    They are off by a share of what they explain, but plain ones together hardly by more than they leave above the
    floor.
    """
    samples = sum(evidence.data.samples.values())
    rest = OF_THE_REST * max(0.0, current.total - samples) if plain else math.inf
    return min(PARSIMONY * (evidence.null().total - current.total), rest)


def is_plain(evidence: Evidence, term: Term) -> bool:
    """Return whether a cause is one of the laws that are fitted at once, on this evidence."""
    return term.effect.ordinary and bool(term.effect.plain_shapes(evidence.views, term.site))


def pruned(evidence: Evidence, current: Fit, left_over: Left, relative: bool) -> Fit:
    """Drop causes whose removal costs nothing, among equals the last chosen first; at least one cause is kept.

    Args:
        evidence: that the fit is of.
        current: to be pruned.
        left_over: says which gaps are left under a fit: a cause without which one opens again is kept.
        relative: whether an ordinary cause may be worth little beside what all explain, if it is much of what they
            leave.
    """

    def worth(now: Fit, i: int, without: Fit) -> bool:
        plain = relative and is_plain(evidence, now.terms[i])
        price = NEEDED * complexity(now.terms[i]) + law_error(evidence, now, plain)
        return without.total - now.total > price or bool(set(left_over(without)) - set(left_over(now)))

    return pruned_by(evidence, current, worth)
