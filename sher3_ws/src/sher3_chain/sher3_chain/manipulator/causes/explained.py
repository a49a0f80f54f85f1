"""One set of causes of a whole arm, and what would explain as much in the place of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import Attribution, without_term
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.thresholds import NEEDED, RIVAL

from sher3_chain.manipulator.causes.payload import centred, on_links
from sher3_chain.manipulator.causes.plan import spent
from sher3_chain.manipulator.evidence import ArmMotionEvidence


@dataclass(frozen=True)
class Explained:
    """One set of causes of the whole arm.

    Attributes:
        fit: all terms together; the payload first of the causes where there is one.
        alone: what the engine's search said of each force balance, and of each pair of encoders, alone.
    """

    fit: Fit
    alone: Sequence[Attribution]

    @property
    def cost(self) -> float:
        """Held-out loss and the price of every number."""
        return spent(self.fit)


def with_rivals(
    evidence: ArmMotionEvidence, candidates: Candidates, best: Explained, others: Sequence[Explained]
) -> Attribution:
    """Add to every cause what would explain as much: rivals at its joint, and what other sets have in its place.

    A link that is too heavy and a rotor do what a payload does alone: it is the rival of both.
    """
    terms, rivals, ranking = best.fit.terms, [], []
    alike = [other.fit.terms for other in others if _alike(evidence, best, other)]
    taken = {t.key for t in terms}
    of_joints = {_name(t): (found, i) for found in best.alone for i, t in enumerate(found.fit.terms)}
    for i, term in enumerate(terms):
        rest = [t for j, t in enumerate(terms) if j != i]
        if _name(term) in of_joints:
            found, k = of_joints[_name(term)]
            own = [f.terms[-1] for f in found.rivals[k]]
            ranking.append(found.ranking[k])
        else:
            own = []
            ranking.append(())
        trials = [fit(evidence.data, [*rest, candidates.term(t.effect, t.site, t.shape)]) for t in own]
        trials += _other_loads(evidence, candidates, best, i)
        new = [t for other in alike if term.key not in {t.key for t in other} for t in other if t.key not in taken]
        trials += [fit(evidence.data, [*rest, t]) for t in new]
        rivals.append(tuple(trials))
    explained = tuple(without_term(evidence, best.fit, i).total - best.fit.total for i in range(len(terms)))
    return Attribution(best.fit, tuple(rivals), explained, tuple(ranking), len(evidence.nuisance))


def _other_loads(evidence: ArmMotionEvidence, candidates: Candidates, best: Explained, index: int) -> list[Fit]:
    """Return the fits with another load on the same link in the place of one, that explain as much."""
    term, others = best.fit.terms[index], [t for j, t in enumerate(best.fit.terms) if j != index]
    pages = on_links(candidates)
    if term.effect not in pages:
        return []
    loads = [
        candidates.term(e, term.site, {}) for e in pages if e is not term.effect and e.shapes(evidence.views, term.site)
    ]
    trials = [centred(candidates, fit(evidence.data, [*others, load])) for load in loads if load.channels]
    room = max(NEEDED, RIVAL * (without_term(evidence, best.fit, index).total - best.fit.total))
    return [t for t in trials if t.admissible and t.total - best.fit.total < room]


def _name(term: Term) -> tuple[object, ...]:
    """Return what tells a term from all others: a late effort and a late encoder of one joint differ by shape alone."""
    return (*term.key, *sorted(term.shape.items()))


def _alike(evidence: ArmMotionEvidence, best: Explained, second: Explained) -> bool:
    """Whether a second set of causes explains as much as the best one, but for the share that a rival may leave.

    The share is of what those causes explain that the second set does not have.
    """
    kept = {t.key for t in second.fit.terms}
    without = fit(evidence.data, [t for t in best.fit.terms if t.key in kept])
    return second.fit.total - best.fit.total < max(NEEDED, RIVAL * (without.total - best.fit.total))
