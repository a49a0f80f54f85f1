"""How the causes of one axis are looked for: the engine's search, and one that begins with a dry friction."""

from __future__ import annotations

from dataclasses import replace

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import Attribution, with_rivals
from sher3_diagnosis.attribute.search import Left, Say, attribute
from sher3_diagnosis.fit.fitting import Fit, fit
from sher3_diagnosis.thresholds import NEEDED

from sher3_machines.axes.evidence import AxisEvidence
from sher3_machines.axes.identification.rest import Bounded, DryFirst, rest_loss

POLISHES = 4
"""Rounds over the causes at most: the second lets the first cause see the polished last one."""


def causes_of_axis(evidence: AxisEvidence, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
    """Choose the causes of an axis.

    Where the choice leaves a force at rest that nothing holds, a second search starts with a dry friction. Of the two
    the one with the smaller loss is taken, in motion and at rest together.
    """
    candidates = Bounded(evidence, candidates.effects, candidates.terms)
    found = attribute(candidates, left_over, say)
    if rest_loss(evidence, found.fit) > 0.0:
        dry = DryFirst(evidence, candidates.effects, candidates.terms)
        other = attribute(dry, left_over, say)
        found = min((found, other), key=lambda a: a.fit.total + rest_loss(evidence, a.fit))
    best = polished(candidates, found)
    if [t.effect.id for t in best.terms] == [t.effect.id for t in found.fit.terms]:
        found = replace(found, fit=best)
    else:
        found = with_rivals(candidates, best)
    return replace(found, rivals=_at_rest_too(evidence, found))


def _at_rest_too(evidence: AxisEvidence, found: Attribution) -> tuple[tuple[Fit, ...], ...]:
    """Return the rivals that leave no more at rest than the causes do: what motion cannot tell, rest may."""
    most = rest_loss(evidence, found.fit) + NEEDED
    return tuple(tuple(f for f in rivals if rest_loss(evidence, f) < most) for rivals in found.rivals)


def polished(candidates: Candidates, found: Attribution) -> Fit:
    """Search every cause again beside the others, and its rivals in its place: it was chosen before they were there.

    The causes keep their order.
    """
    best = found.fit
    for _ in range(POLISHES):
        before = best
        for i in found.causes:
            term = best.terms[i]
            others = [t for j, t in enumerate(best.terms) if j != i]
            effects = [term.effect, *(f.terms[-1].effect for f in found.rivals[i] if f.terms[-1].site == term.site)]
            for effect in effects:
                trial = candidates.best(effect, term.site, others)
                if trial is not None and trial.total < best.total:
                    terms = [*others[:i], trial.terms[-1], *others[i:]]
                    best = fit(candidates.evidence.data, terms)
        if best is before:
            break
    return best
