"""A cause whose law holds at any speed shows away from a reversal too; what shows only there is a friction's own shape.

About a reversal the count of an encoder, the period of the samples and the filter bend the step of a dry friction. A
late effort, a spring or a mass can take up some of that. Away from reversals nothing of it is left to take up.
"""

from __future__ import annotations

from sher3_diagnosis.attribute.candidates import complexity
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.fit.term import again
from sher3_diagnosis.thresholds import NEEDED

from sher3_chain.search.friction_in_motion import without_slow

SHAPED = ("friction", "lost_motion", "compliance")
"""Families whose laws live at a reversal, or shape it."""


def without_reversal_only(evidence: Evidence, found: Attribution) -> Attribution:
    """Return the causes without those that show at reversals alone; the others are fitted again."""
    only = idle_away_from_reversals(evidence, found.fit)
    return found.kept(evidence, [i for i in found.causes if i not in only])


def idle_away_from_reversals(evidence: Evidence, found: Fit) -> set[int]:
    """Return the terms of a fit with dry friction that are not worth their numbers away from its reversals."""
    dry = {t.site for t in found.terms if t.effect.dry}
    judged = [i for i, t in enumerate(found.terms) if t.site in dry and t.effect.family not in SHAPED and _force(t)]
    if not judged:
        return set()
    data = without_slow(evidence, dry).data
    terms = again(data, found.terms)
    whole = fit(data, terms).total
    worth = {i: fit(data, [*terms[:i], *terms[i + 1 :]]).total - whole for i in judged}
    return {i for i, gain in worth.items() if gain < NEEDED * complexity(found.terms[i])}


def _force(term: Term) -> bool:
    """Return whether a cause shows in the force balance alone."""
    return bool(term.channels) and all(c.stage == "motor_mechanics" for c in term.channels)
