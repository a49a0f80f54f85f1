"""A search that begins with a dry friction and what hides behind the only encoder of an axis.

A load behind a gap or a spring shows in the effort only beside the friction, whose reversal it shapes: step by step a
friction that builds up slowly would be taken for both.
"""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.attribute.candidates import Candidates, cost
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.fit.fitting import Fit, Term

FAMILIES = ("compliance", "timing")
"""Family of the first cause, beside plain friction: a spring that rings. Of the second, beside all that hides: a late
effort, since a load that gives way is late too."""
ROUNDS = 4
"""Rounds over friction and load at most."""


def something_hides(candidates: Candidates, found: Fit) -> bool:
    """Return whether the runs can show any effect behind the only encoder."""
    views = candidates.evidence.views
    hidden = [e for e in candidates.effects if e.unseen]
    return bool(views) and any(e.shapes(views, site) for e in hidden for site in candidates.sites(e))


def friction_then_hidden(candidates: Candidates, trials: list[Fit], given: Sequence[Term]) -> list[Fit]:
    """Return the trials of a step: of plain dry friction first, then of what hides, each beside the other."""
    chosen = len(given) - len(candidates.evidence.nuisance)
    if chosen >= len(FAMILIES):
        return trials
    in_turn = [trial for trial in trials if _in_turn(trial.terms[-1].effect, chosen)]
    if not chosen:
        return in_turn
    sharp = [_beside(candidates, trial, _sharp(candidates, given)) for trial in in_turn]
    return sorted((_beside(candidates, trial, given) for trial in [*in_turn, *sharp]), key=cost)


def _in_turn(effect: Effect, chosen: int) -> bool:
    """Return whether an effect may be the first cause, or the second."""
    hides = effect.unseen and bool(chosen)
    return (effect.plain and effect.dry) or hides or effect.family == FAMILIES[chosen]


def _sharp(candidates: Candidates, given: Sequence[Term]) -> Sequence[Term]:
    """Return terms with a friction that reverses at once: alone it builds up as slowly as the load comes in."""
    *before, friction = given
    shapes = friction.effect.shapes(candidates.evidence.views, friction.site)
    return [*before, candidates.term(friction.effect, friction.site, shapes[0])]


def _beside(candidates: Candidates, trial: Fit, given: Sequence[Term]) -> Fit:
    """Return a fit whose last two causes are searched again beside each other, from the given friction on."""
    (*before, friction), load, best = given, trial.terms[-1], trial
    for _ in range(ROUNDS):
        again = candidates.best(load.effect, load.site, [*before, friction])
        rubs = again and candidates.best(friction.effect, friction.site, [*before, again.terms[-1]])
        if again is None or rubs is None:
            break
        best, friction = min(best, again, key=lambda f: f.total), rubs.terms[-1]
    return best
