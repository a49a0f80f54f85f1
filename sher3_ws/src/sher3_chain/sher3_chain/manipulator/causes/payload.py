"""A payload that several joints of an arm carry: at which link, how heavy, and whether the joints bear it out."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.attribute.candidates import Candidates, cost, possible
from sher3_diagnosis.attribute.rivals import without_term
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.thresholds import NEEDED, PARSIMONY

from sher3_chain.manipulator.evidence import ArmMotionEvidence
from sher3_chain.search.friction_in_motion import FRICTION
from sher3_chain.thresholds import LEAST_CLOSURE

ON_LINK = "link"
"""Kind of place that a payload sits on."""
CENTRE = ("x", "y", "z")
"""Parameters of the centre of a payload."""
HEAVIEST = 2.0
"""Mass of a payload over that of the whole arm at most: what is heavier is no body on a link."""
CENTRE_ROUNDS = 3
"""Rounds on the centre of a payload: its inertia is that of a point there, and small beside its weight."""


def payload(evidence: ArmMotionEvidence, candidates: Candidates) -> Fit | None:
    """Return the fit of a payload at the link that needs it most, beside plain friction; None where none is needed."""
    pages = [e for e in candidates.effects if ON_LINK in e.places]
    rubbing = [(e, j) for j in evidence.judged for e in plain_frictions(candidates)]
    plain = [*evidence.nuisance, *(candidates.term(e, j, middle(e, evidence, j)) for e, j in rubbing)]
    base, null = fit(evidence.data, plain), evidence.null().total
    places = [(page, link) for page in pages for link in evidence.places["link"] if page.shapes(evidence.views, link)]
    trials = [t for page, link in places if (t := _at(evidence, candidates, page, link, plain)) is not None]
    if not trials:
        return None
    best = min(trials, key=cost)
    worth = NEEDED * best.terms[-1].width + PARSIMONY * (null - base.total)
    worthy = base.total - best.total > worth and shows_on_enough(base, best)
    return best if worthy else None


def shows_on_enough(base: Fit, best: Fit) -> bool:
    """Return whether a payload, the last term of `best`, is seen by two of the joints that carry it, or the only one.

    A payload that one joint of several feels is an inertia or a force of that joint.
    """
    carrying = best.terms[-1].channels
    gains = dict.fromkeys(carrying, 0.0)
    for (run, channel), loss in best.loss.items():
        if channel in gains:
            gains[channel] += base.loss.get((run, channel), loss) - loss
    return sum(gain > NEEDED for gain in gains.values()) >= min(2, len(carrying))


def closes(evidence: ArmMotionEvidence, loaded: Fit) -> bool:
    """Return whether a payload, the first term, shrinks the gaps of joints that carry it by a share worth a name."""
    first = len(evidence.nuisance)
    carrying = loaded.terms[first].channels
    gap = sum(loss for (_, channel), loss in evidence.null().loss.items() if channel in carrying)
    return without_term(evidence, loaded, first).total - loaded.total > LEAST_CLOSURE * gap


def plain_frictions(candidates: Candidates) -> list[Effect]:
    """Return the plain laws of friction."""
    return [e for e in candidates.effects if e.plain and e.family == FRICTION]


def middle(effect: Effect, evidence: ArmMotionEvidence, joint: str) -> dict[str, float]:
    """Return the middle one of the shapes of an effect at a joint."""
    shapes = effect.shapes(evidence.views, joint)
    return dict(shapes[len(shapes) // 2])


def _at(
    evidence: ArmMotionEvidence, candidates: Candidates, page: Effect, link: str, plain: Sequence[Term]
) -> Fit | None:
    """Fit a payload at a link."""
    trial = fit(evidence.data, [*plain, candidates.term(page, link, {})])
    if not possible(trial):  # friction that is not there may fit below zero
        return None
    found = centred(candidates, trial)
    model, values = evidence.records[0].model, page.parameters({}, found.of(len(plain)))
    mass = values.get("mass", values.get("relative", 0.0) * model.mass_of(link))
    return found if not model.mass or mass < HEAVIEST * model.mass else None


def centred(candidates: Candidates, found: Fit) -> Fit:
    """Return a fit with the inertia of its last term, where that has a centre, about the centre of the round before."""
    last = len(found.terms) - 1
    page, link = found.terms[last].effect, found.terms[last].site
    for _ in range(CENTRE_ROUNDS if set(CENTRE) <= page.units.keys() else 0):
        values = page.parameters({}, found.of(last))
        shape = {name: round(values[name], 4) for name in CENTRE}
        trial = fit(candidates.evidence.data, [*found.terms[:last], candidates.term(page, link, shape)])
        if not possible(trial):
            break
        found = trial
    return found
