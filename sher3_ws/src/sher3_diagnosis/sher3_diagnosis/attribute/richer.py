"""A richer law in the place of a plain one, with all other plain laws fitted beside it.

What a plain dry friction leaves about a reversal hides a late effort or a viscous friction, or is taken for one. So the
richer law is not looked for in what the plain laws leave: they are fitted again beside it.
"""

from __future__ import annotations

from sher3_diagnosis.attribute.candidates import Candidates, complexity, cost
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.together import Left, law_error, together
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term
from sher3_diagnosis.thresholds import NEEDED


def beside_richer(candidates: Candidates, plain: Fit, left_over: Left) -> Fit | None:
    """Fit the plain laws at once beside the richer law of dry friction that fits best in place of the plain law.

    Laws whose shape was searched beside the plain friction, such as a delay, are not beside the richer one at first. A
    law that the plain friction hides may be: without a viscous friction the other does not fall with speed.

    Returns:
        None where no dry friction is among the plain laws, or no richer law is possible.
    """
    dry = next((t for t in plain.terms if t.effect.dry), None)
    if dry is None:
        return None
    others = [t for t in plain.terms if t is not dry and not any(t.fixed)]
    laws = [e for e in candidates.effects if e.dry and dry.effect.id in e.extends]
    starts = [others, *([*others, t] for t in _hidden(candidates, plain, dry))]
    trials = [f for e in laws for start in starts if (f := candidates.best(e, dry.site, start)) is not None]
    if not trials:
        return None
    return together(candidates, candidates.evidence.channels, left_over, [min(trials, key=cost).terms[-1]])


def _hidden(candidates: Candidates, plain: Fit, dry: Term) -> list[Term]:
    """Return the linear plain frictions at the place of a dry one, in their first shape, that are not in a fit."""
    views, site, held = candidates.evidence.views, dry.site, {t.effect.id for t in plain.terms}
    laws = [e for e in candidates.effects if e.ordinary and e.family == dry.effect.family and e.id not in held]
    terms = [candidates.term(e, site, shape) for e in laws for shape in e.plain_shapes(views, site)[:1]]
    return [t for t in terms if t.width and not any(t.fixed)]


def pays(evidence: Evidence, rich: Attribution, found: Attribution) -> bool:
    """Return whether an attribution with a richer law is worth its numbers on parts left out."""
    more = _numbers(rich) - _numbers(found)
    return found.fit.total - rich.fit.total > NEEDED * more + law_error(evidence, rich.fit, plain=True)


def _numbers(found: Attribution) -> int:
    return sum(complexity(found.fit.terms[i]) for i in found.causes)
