"""How the causes of one axis are looked for: the engine's search, and one that begins with a dry friction."""

from __future__ import annotations

from dataclasses import replace

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.search import Left, Say, attribute
from sher3_diagnosis.fitting import Fit, fit

from sher3_machines.axes.evidence import AxisEvidence
from sher3_machines.axes.rest import DryFirst, rest_loss

POLISHES = 2
"""Rounds over the causes: the second lets the first cause see the polished last one."""


def causes_of_axis(evidence: AxisEvidence, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
    """Choose the causes of an axis.

    Where the choice leaves a force at rest that nothing holds, a second search starts with a dry friction. Of the two
    the one with the smaller loss is taken, in motion and at rest together.
    """
    found = attribute(candidates, left_over, say)
    if rest_loss(evidence, found.fit) > 0.0:
        dry = DryFirst(evidence, candidates.effects, candidates.terms)
        other = attribute(dry, left_over, say)
        found = min((found, other), key=lambda a: a.fit.total + rest_loss(evidence, a.fit))
    return replace(found, fit=polished(candidates, found.fit))


def polished(candidates: Candidates, found: Fit) -> Fit:
    """Search the shape of every cause again beside the others: it was chosen before they were there.

    The causes keep their order, which their rivals share.
    """
    best = found
    for _ in range(POLISHES):
        for key in [term.key for term in best.terms]:
            term = next(t for t in best.terms if t.key == key)
            trial = candidates.best(term.effect, term.site, [t for t in best.terms if t.key != key])
            if trial is not None and trial.total < best.total:
                best = trial
    improved = {term.key: term for term in best.terms}
    return fit(candidates.evidence.data, [improved[term.key] for term in found.terms])
