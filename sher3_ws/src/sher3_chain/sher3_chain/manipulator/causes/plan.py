"""How the causes of one joint of an arm are looked for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from sher3_diagnosis.attribute.candidates import Candidates, complexity, price
from sher3_diagnosis.attribute.plan import SearchPlan
from sher3_diagnosis.attribute.rivals import without_term
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.thresholds import NEEDED

from sher3_chain.manipulator.causes.confounding import GAIN
from sher3_chain.search.away_from_reversals import without_reversal_only
from sher3_chain.search.one_joint import possible_at_one_joint
from sher3_chain.thresholds import CAUSES_OF_JOINT, CONFOUNDED

LIKE_WEIGHT = "spring"
"""Family of laws of a joint that do what other weights of bodies do, as long as the other joints follow its own."""


def spent(found: Fit) -> float:
    """Return the held-out loss of a fit and the price of every number."""
    return found.total + sum(price(t) for t in found.terms)


def bought(evidence: Evidence, found: Fit, first: int) -> Fit:
    """Return a fit of a whole arm without the terms from `first` on that are not worth their numbers beside the others.

    A joint searched alone has use for laws that a load takes over.
    """
    while len(found.terms) > first:
        fewer = [without_term(evidence, found, i) for i in range(first, len(found.terms))]
        gains = [
            x.total - found.total - NEEDED * complexity(t) for x, t in zip(fewer, found.terms[first:], strict=True)
        ]
        least = min(range(len(gains)), key=gains.__getitem__)
        if gains[least] > 0.0:
            break
        found = fewer[least]
    return found


def plain_before_richer(candidates: Candidates, trials: list[Fit], given: Sequence[Term]) -> list[Fit]:
    """Return the trials of a step; a plain law first where it and another plain one are as cheap as the best trial.

    Friction that varies with the position takes up a viscous one as long as that is not there. It is a cause where it
    is worth its numbers beside both plain laws.
    """
    if not trials:
        return trials
    best = trials[0].terms[-1]
    own = [f for f in trials if f.terms[-1].site == best.site]
    first = next((f for f in own if f.terms[-1].effect.id in best.effect.extends), None)
    if first is None:
        return trials
    plain = [f.terms[-1] for f in own if f is not first and f.terms[-1].effect.plain]
    pairs = [fit(candidates.evidence.data, [*first.terms, term]) for term in plain]
    cheaper = any(pair.admissible and spent(pair) <= spent(trials[0]) for pair in pairs)
    return [first, *(f for f in trials if f is not first)] if cheaper else trials


def possible_at_joint(trial: Fit) -> bool:
    """Return whether a trial is possible at a joint of an arm.

    A cause that is many times what all of them make together is taken back by another one: over a short travel a weight
    and a cable are alike.
    """
    return trial.cancelled * CONFOUNDED <= 1.0 and possible_at_one_joint(trial)


def beside_links(trial: Fit) -> bool:
    """Return whether a trial is possible beside links found from the data: a share of what the model says is not."""
    term = trial.terms[-1]
    return not term.effect.scales_model(term.shape) and possible_at_joint(trial)


def laws_beside_links(effects: Iterable[Effect]) -> list[Effect]:
    """Return the laws that a joint may have beside links found from the data.

    Neither a gain, a share of what the model says, nor a spring: both stand for weights that the links have by now.
    """
    return [e for e in effects if e.family != LIKE_WEIGHT and e.scales != GAIN]


JOINT = SearchPlan(
    causes=CAUSES_OF_JOINT,
    down_to_floor=True,
    possible=possible_at_joint,
    order=plain_before_richer,
    reviews=(without_reversal_only,),
)
"""How the causes of one force balance, or of one pair of encoders, are looked for."""

TOGETHER = replace(JOINT, together=True)
"""The same with plain laws at once and by what they are worth: beside a payload or a wrong mass, which would take up
what a joint leaves below its own floor, and the other joints with it; and as a second try where the law of a servo
stands for the effort, of which a late command, taken first, takes up the friction."""

BESIDE_LINKS = replace(JOINT, possible=beside_links)
"""The same beside links found from the data."""
