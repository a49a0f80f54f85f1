"""The one search for causes: it follows the plan that a machine declares."""

from __future__ import annotations

from dataclasses import replace

from sher3_common.progress import Say

from sher3_diagnosis.attribute.candidates import Candidates, price
from sher3_diagnosis.attribute.exchange import exchanged, over_floor
from sher3_diagnosis.attribute.plan import Opening, SearchPlan
from sher3_diagnosis.attribute.richer import beside_richer, pays
from sher3_diagnosis.attribute.rivals import Attribution, with_rivals
from sher3_diagnosis.attribute.search import Left, attribute
from sher3_diagnosis.attribute.stepwise import layered
from sher3_diagnosis.attribute.together import pruned, together
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit


def planned(candidates: Candidates, plan: SearchPlan, left_over: Left, say: Say) -> Attribution:
    """Choose the causes of one piece of evidence.

    Args:
        candidates: the evidence and the effects that may explain it.
        plan: of the machine, for this evidence.
        left_over: says which gaps are left under a fit: channel -> excess loss.
        say: takes a line of progress.
    """
    evidence = candidates.evidence
    candidates = replace(candidates, possible=plan.possible, order=plan.order)
    seen = replace(candidates, effects=[e for e in candidates.effects if not e.unseen])
    found = _first(seen, plan, left_over, say)
    for opening in plan.openings:
        if opening.tried(candidates, found.fit):
            looked = replace(candidates if opening.unseen else seen, order=opening.order)
            other = attribute(looked, left_over, say, plan.causes)
            found = other if _better(evidence, plan, opening, found.fit, other.fit) else found
    if plan.together:
        found = _refined(candidates, found, left_over)
    for review in plan.reviews:
        found = review(evidence, found)
    return found


def _first(candidates: Candidates, plan: SearchPlan, left_over: Left, say: Say) -> Attribution:
    """Return the causes that the search finds without an opening."""
    if plan.layers:
        return layered(candidates, left_over, say)
    if plan.together:
        return _plain_first(candidates, plan, left_over, say)
    if plan.single is not None:
        one = plan.single(candidates.evidence, attribute(candidates, left_over, say, causes=1))
        if not left_over(one.fit):
            return one
    return attribute(candidates, left_over, say, plan.causes)


def _plain_first(candidates: Candidates, plan: SearchPlan, left_over: Left, say: Say) -> Attribution:
    """Fit the plain laws at once and look for richer ones in what they leave; where a gap is left, search by steps too.

    Of the two the one is taken whose loss, with the price of its numbers, is smaller; then the one with a richer dry
    friction from the start, where that pays.
    """
    say("fitting the plain laws together")
    null = candidates.evidence.null()
    plain = together(candidates, candidates.evidence.channels, left_over) if left_over(null) else null
    found = _refined(candidates, attribute(candidates, left_over, say, plan.causes, plain), left_over)
    if left_over(found.fit):
        stepped = _refined(candidates, attribute(candidates, left_over, say, plan.causes), left_over)
        found = min((found, stepped), key=_priced)
    start = beside_richer(candidates, plain, left_over)
    if start is None:
        return found
    rich = _refined(candidates, attribute(candidates, left_over, say, plan.causes, start), left_over)
    return rich if pays(candidates.evidence, rich, found) else found


def _refined(candidates: Candidates, found: Attribution, left_over: Left) -> Attribution:
    """Return an attribution whose causes were searched again beside the others, without those nobody misses then."""
    best = pruned(candidates.evidence, exchanged(candidates, found), left_over, relative=True)
    if [t.effect.id for t in best.terms] == [t.effect.id for t in found.fit.terms]:
        return replace(found, fit=best)
    return with_rivals(candidates, best)


def _priced(found: Attribution) -> float:
    """Return the held-out loss of a fit and the price of the numbers of its causes."""
    return found.fit.total + sum(price(found.fit.terms[i]) for i in found.causes)


def _better(evidence: Evidence, plan: SearchPlan, opening: Opening, found: Fit, other: Fit) -> bool:
    """Return whether the fit of an opening has a loss above the floor that is smaller by the share it asks for."""
    before, after = (over_floor(evidence, x) + plan.beyond(evidence, x) for x in (found, other))
    return after < (1.0 - opening.worth) * before
