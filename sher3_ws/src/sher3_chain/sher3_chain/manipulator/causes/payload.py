"""A payload that several joints of an arm carry: at which link, how heavy, and whether the joints bear it out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.attribute.candidates import Candidates, cost, possible
from sher3_diagnosis.attribute.rivals import without_term
from sher3_diagnosis.attribute.together import law_error, without_impossible
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.thresholds import NEEDED

from sher3_chain.manipulator.evidence import ArmMotionEvidence
from sher3_chain.thresholds import LEAST_CLOSURE

ON_LINK = "link"
"""Kind of place that a payload sits on."""
CENTRE = ("x", "y", "z")
"""Parameters of the centre of a payload."""
HEAVIEST = 2.0
"""Mass of a payload over that of the whole arm at most: what is heavier is no body on a link."""
DISTANCES = (0.05, 0.1, 0.2, 0.4, 0.8)
"""Distances from the joint of its link, m, at which the centre of a payload is looked for."""
SETTLED = 0.05
"""Distance of a centre from the one before over its own, below which it is found."""
CENTRE_ROUNDS = 6
"""Rounds on the centre of a payload, each linear about the one before, so that few are needed."""


class Load(NamedTuple):
    """A load on a link beside plain laws of all joints, the last term of a fit, and whether enough joints feel it."""

    fit: Fit
    felt: bool


def payloads(evidence: ArmMotionEvidence, candidates: Candidates, plain: Sequence[Term]) -> list[Load]:
    """Return each law of a load at the link that needs it most, beside `plain` laws of all joints.

    None of a law that is not needed.
    """
    base, found = without_impossible(evidence, fit(evidence.data, plain)), list[Load]()
    for page in on_links(candidates):
        links = [link for link in evidence.places["link"] if page.shapes(evidence.views, link)]
        trials = [t for link in links if (t := _at(evidence, candidates, page, link, plain)) is not None]
        if trials:
            best = min(trials, key=cost)
            worth = NEEDED * best.terms[-1].width + law_error(evidence, best, plain=True)
            if base.total - best.total > worth:
                found.append(Load(best, shows_on_enough(evidence, base, best)))
    return found


def on_links(candidates: Candidates) -> list[Effect]:
    """Return the laws of what sits on a link."""
    return [e for e in candidates.effects if ON_LINK in e.places]


def beside(evidence: ArmMotionEvidence, candidates: Candidates) -> list[Term]:
    """Return the plain laws of every joint's own; a dry friction in the shape that leaves least beside the others."""
    laws = [(e, j) for j in evidence.judged for e in own_laws(candidates) if e.shapes(evidence.views, j)]
    own = [candidates.term(e, j, middle(e, evidence, j)) for e, j in laws]
    plain = [*evidence.nuisance, *(t for t in own if t.channels)]  # what shows nowhere has no number either
    for dry in [t for t in plain if t.effect.dry]:
        others = [t for t in plain if t is not dry]
        shapes = dry.effect.plain_shapes(evidence.views, dry.site)
        trials = [fit(evidence.data, [*others, candidates.term(dry.effect, dry.site, shape)]) for shape in shapes]
        plain = list(min(trials, key=lambda trial: trial.total).terms)
    return plain


def shows_on_enough(evidence: ArmMotionEvidence, base: Fit, best: Fit) -> bool:
    """Return whether a payload, the last term of `best`, is seen by two of the joints that carry it, or the only one.

    What one joint of several feels may as well be an inertia or a force of that joint.
    """
    gains = [evidence.loss(c, base) - evidence.loss(c, best) for c in best.terms[-1].channels]
    return sum(gain > NEEDED for gain in gains) >= min(2, len(gains))


def closes(evidence: ArmMotionEvidence, loaded: Fit) -> bool:
    """Return whether a payload, the first term, shrinks the gaps of joints that carry it by a share worth a name.

    Beside large gaps of other causes that is a small one: it is also worth a name where it takes more than all leave.
    """
    first = len(evidence.nuisance)
    gap = sum(evidence.loss(channel, evidence.null()) for channel in loaded.terms[first].channels)
    rest = max(0.0, loaded.total - sum(evidence.data.samples.values()))
    return without_term(evidence, loaded, first).total - loaded.total > min(LEAST_CLOSURE * gap, rest)


def own_laws(candidates: Candidates) -> list[Effect]:
    """Return the plain laws of a joint that scale nothing of what the model says: friction, spring and rotor."""
    return [e for e in candidates.effects if e.plain and not e.scales and "axis" in e.places]


def middle(effect: Effect, evidence: ArmMotionEvidence, joint: str) -> dict[str, float]:
    """Return the middle one of the shapes of an effect at a joint."""
    shapes = effect.shapes(evidence.views, joint)
    return dict(shapes[len(shapes) // 2])


def _at(
    evidence: ArmMotionEvidence, candidates: Candidates, page: Effect, link: str, plain: Sequence[Term]
) -> Fit | None:
    """Fit a payload at a link."""
    term = candidates.term(page, link, {})
    if not term.channels:
        return None
    trial = about_its_own(candidates, fit(evidence.data, [*plain, term]))
    found = without_impossible(evidence, trial) if possible(trial) else trial
    if not found.terms or found.terms[-1].effect is not page or not possible(found):
        return None
    model, values = evidence.records[0].model, page.parameters({}, found.of(len(found.terms) - 1))
    mass = values.get("mass", values.get("relative", 0.0) * model.mass_of(link))
    return found if not model.mass or mass < HEAVIEST * model.mass else None


def about_its_own(candidates: Candidates, found: Fit) -> Fit:
    """Return a fit with the last term about its own centre, looked for outwards where no centre is found from `found`.

    Its weight tells mass times distance, and which way; the distance, and with it the mass, is told by its inertia.
    """
    best, page, link = centred(candidates, found), found.terms[-1].effect, found.terms[-1].site
    moment = np.asarray(found.of(len(found.terms) - 1))[1:]
    size = float(np.linalg.norm(moment))
    if not set(CENTRE) <= page.units.keys() or not size or (possible(best) and _is_centred(best)):
        return best
    for distance in DISTANCES:
        shape = dict(zip(CENTRE, map(float, moment * distance / size), strict=True))
        start = fit(candidates.evidence.data, [*found.terms[:-1], candidates.term(page, link, shape)])
        trial = centred(candidates, start)
        if possible(trial) and (not possible(best) or trial.total < best.total):
            best = trial
    return best


def _is_centred(found: Fit) -> bool:
    """Return whether the last term of a fit is reckoned about the centre that it has."""
    term = found.terms[-1]
    values = term.effect.parameters(term.shape, found.of(len(found.terms) - 1))
    apart = np.linalg.norm([values[name] - term.shape.get(name, 0.0) for name in CENTRE])
    return bool(apart < SETTLED * np.linalg.norm([values[name] for name in CENTRE]))


def centred(candidates: Candidates, found: Fit, at: int = -1) -> Fit:
    """Return a fit with the inertia of a term, where that has a centre, about the centre that the fit itself finds.

    About the joint of its link, where it begins, a body may look impossible whose centre lies far from there.

    Args:
        candidates: that evaluate terms.
        found: the fit.
        at: which of its terms; default the last.
    """
    at %= len(found.terms)
    page, link = found.terms[at].effect, found.terms[at].site
    for _ in range(CENTRE_ROUNDS if set(CENTRE) <= page.units.keys() else 0):
        values = page.parameters({}, found.of(at))
        shape = {name: round(values[name], 4) for name in CENTRE}
        if shape == found.terms[at].shape:
            break
        term = candidates.term(page, link, shape)
        trial = fit(candidates.evidence.data, [*found.terms[:at], term, *found.terms[at + 1 :]])
        if page.admissible(found.terms[at].shape, found.of(at)) and not page.admissible(shape, trial.of(at)):
            break
        found = trial
    return found
