"""How the causes of a serial arm are looked for: joint by joint, without and with a payload that all joints carry.

What a joint does alone is a matter of its own force balance. A payload shows on several joints at once; it is taken
where it and what the joints then still need are cheaper than what the joints need without it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from sher3_diagnosis.attribute.candidates import Candidates, cost, possible, price
from sher3_diagnosis.attribute.plan import SearchPlan
from sher3_diagnosis.attribute.planned import planned
from sher3_diagnosis.attribute.rivals import Attribution, without_term
from sher3_diagnosis.attribute.search import Say
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term, fit, make_term
from sher3_diagnosis.judge.left_over import down_to_floor
from sher3_diagnosis.thresholds import NEEDED, PARSIMONY, RIVAL
from sher3_diagnosis.tolerance import NUISANCE
from sher3_effects import computed

from sher3_chain.manipulator.confounding import GAIN
from sher3_chain.manipulator.evidence import ArmMotionEvidence, channel_of, channels_of, of_channel
from sher3_chain.manipulator.links import clearly_less, wrong_links
from sher3_chain.manipulator.readings.lateness import LATE, Late, lateness
from sher3_chain.search.away_from_reversals import borne_out
from sher3_chain.search.friction_in_motion import FRICTION, without_slow
from sher3_chain.search.one_joint import of_one_joint
from sher3_chain.thresholds import CAUSES_OF_JOINT, LEAST_CLOSURE

TIMING, ON_LINK = "timing", "link"
"""Family of what is late, and the kind of place that a payload sits on."""
CENTRE = ("x", "y", "z")
"""Parameters of the centre of a payload."""
HEAVIEST = 2.0
"""Mass of a payload over that of the whole arm at most: what is heavier is no body on a link."""
CENTRE_ROUNDS = 3
"""Rounds on the centre of a payload: its inertia is that of a point there, and small beside its weight."""


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


def causes_of_arm(evidence: ArmMotionEvidence, candidates: Candidates, say: Say) -> Attribution:
    """Choose the causes of an arm in motion, with their rivals; none where no joint has a gap."""
    if not down_to_floor(evidence.channels, evidence, evidence.null()):
        return Attribution(evidence.null(), (), (), nuisance=len(evidence.nuisance))
    found = _explained(evidence, candidates, (), None, say)
    best, second = found, None
    loaded = _payload(evidence, candidates)
    if loaded is not None:
        other = _explained(evidence, candidates, loaded.terms[-1:], loaded, say)
        better = other.cost < found.cost and closes(evidence, other)
        best, second = (other, found) if better else (found, other)
    linked = _linked(evidence, candidates, best, say)
    return _with_rivals(evidence, candidates, *((best, second) if linked is None else (linked, None)))


def _linked(evidence: ArmMotionEvidence, candidates: Candidates, best: Explained, say: Say) -> Explained | None:
    """Return the causes beside links with wrong inertial parameters; None where links do not leave clearly less.

    Plain laws of the joints come with the links; richer ones are looked for in what is left.
    """
    page = next((e for e in candidates.effects if e.free() is not None), None)
    if page is None:
        return None
    plain = [e for e in candidates.effects if e.plain and e.scales != GAIN]
    laws = [(e, j, _middle(e, evidence, j)) for j in evidence.judged for e in plain]
    links = wrong_links(evidence, page, laws)
    if not links:
        return None
    loads = [candidates.term(*link) for link in links]
    other = _explained(evidence, candidates, loads, fit(evidence.data, loads), say)
    return other if clearly_less(evidence, other.fit, best.fit, page) else None


def _explained(
    evidence: ArmMotionEvidence, candidates: Candidates, loads: Sequence[Term], loaded: Fit | None, say: Say
) -> Explained:
    """Search every joint for causes beside `loads` on links, as `loaded` has them, and fit all of them together.

    What lies between two encoders says nothing of a force balance, since the links move as their own encoders say.
    """
    effects = [e for e in candidates.effects if e.places == ("axis",)]
    beside = _added(evidence, loaded, loads) if loaded is not None else ()
    links = any(load.effect.free() is not None for load in loads)
    alone: list[Attribution] = []
    for channel in (c for joint in evidence.judged for c in channels_of(joint)):
        own = of_channel(evidence, channel, beside)
        say(f"{channel}{' beside ' + ' and '.join(t.site for t in loads) if loads else ''}")
        balance = channel == channel_of(channel.actuator)
        late = lateness(evidence, channel.actuator, beside) if balance else None
        alone.append(_beside_delay(own, late, effects, say, links) if balance else _searched(own, effects, say))
    terms = [*evidence.nuisance, *loads]
    for found in alone:
        terms += [candidates.term(t.effect, t.site, t.shape) for t in _causes(found)]
    return Explained(fit(evidence.data, terms), alone)


def _causes(found: Attribution) -> list[Term]:
    return [t for t in found.fit.terms if t.effect.family != NUISANCE]


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


def beside_links(trial: Fit) -> bool:
    """Return whether a trial is possible beside links found from the data: a share of what the model says is not."""
    term = trial.terms[-1]
    return not term.effect.of_model(term.shape) and of_one_joint(trial)


JOINT = SearchPlan(
    causes=CAUSES_OF_JOINT,
    down_to_floor=True,
    possible=of_one_joint,
    order=plain_before_richer,
    reviews=(borne_out,),
)
"""How the causes of one force balance, or of one pair of encoders, are looked for."""


def _searched(own: Evidence, effects: Sequence[Effect], say: Say, links: bool = False) -> Attribution:
    """Search one channel for causes, beside links that were found from the data or not."""
    plan = replace(JOINT, possible=beside_links) if links else JOINT
    return planned(Candidates(own, effects), plan, partial(down_to_floor, own.channels, own), say)


def _beside_delay(own: Evidence, late: Late | None, effects: Sequence[Effect], say: Say, links: bool) -> Attribution:
    """Search the force balance of a joint without and beside a late effort; return what is cheaper.

    The delay is told by its shape: causes may be at the floor without it, and a fit would take up a viscous friction or
    how a dry one turns. Where the shape tells none, none is looked for. They are compared away from reversals, where a
    dry friction is no matter of a moment.
    """
    others = [e for e in effects if e.family != TIMING]
    if late is not None and late.told and not late.sure:
        others = list(effects)
    found = _searched(own, others, say, links)
    if late is None or not late.sure or len(others) == len(effects):
        return found
    site = own.places["axis"][0]
    page = computed(LATE).told()
    trials = [make_term(own.data, page, site, shape) for shape in late.shapes]
    best = min(trials, key=lambda term: fit(own.data, [*found.fit.terms, term]).total)
    beside = _searched(replace(own, nuisance=(best,)), others, say, links)
    return beside if beside.fit.admissible and _worth(own, site, found.fit, beside.fit) > NEEDED else found


def _worth(own: Evidence, site: str, without: Fit, beside: Fit) -> float:
    """Return by how much a fit lowers the loss away from reversals, in units of what it leaves there.

    The floor of an arm counts the noise of all encoders at their worst; a delay shows in what is really left.
    """
    away = without_slow(own, {site}).data
    again = ([make_term(away, t.effect, t.site, t.shape) for t in found.terms] for found in (without, beside))
    first, second = (fit(away, terms).total for terms in again)
    return (first - second) * sum(away.samples.values()) / max(second, 1.0)


def spent(found: Fit) -> float:
    """Return the held-out loss of a fit and the price of every number."""
    return found.total + sum(price(t) for t in found.terms)


def _payload(evidence: ArmMotionEvidence, candidates: Candidates) -> Fit | None:
    """Return the fit of a payload at the link that needs it most, beside plain friction; None where none is needed."""
    pages = [e for e in candidates.effects if ON_LINK in e.places]
    rubbing = [(e, j) for j in evidence.judged for e in _plain(candidates)]
    plain = [*evidence.nuisance, *(candidates.term(e, j, _middle(e, evidence, j)) for e, j in rubbing)]
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


def closes(evidence: ArmMotionEvidence, loaded: Explained) -> bool:
    """Return whether a payload, the first term, shrinks the gaps of joints that carry it by a share worth a name."""
    first = len(evidence.nuisance)
    carrying = loaded.fit.terms[first].channels
    gap = sum(loss for (_, channel), loss in evidence.null().loss.items() if channel in carrying)
    return without_term(evidence, loaded.fit, first).total - loaded.fit.total > LEAST_CLOSURE * gap


def _plain(candidates: Candidates) -> list[Effect]:
    return [e for e in candidates.effects if e.plain and e.family == FRICTION]


def _middle(effect: Effect, evidence: ArmMotionEvidence, joint: str) -> dict[str, float]:
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


def _added(evidence: ArmMotionEvidence, loaded: Fit, loads: Sequence[Term]) -> list[dict[Channel, Array]]:
    """Return what terms of a fit that sit on links add to the residuals of every block, (g, 1) in SI units."""
    at = [i for i, term in enumerate(loaded.terms) if any(term is load for load in loads)]
    seen: dict[int, dict[Channel, Array]] = {}
    for view in evidence.views:
        if id(view) in seen:
            continue
        added: dict[Channel, Array] = {}
        for i in at:
            term, coefficients = loaded.terms[i], loaded.of(i)
            own = term.effect.signature(view, term.site, term.shape)
            for c, x in [*own.fixed.items(), *((c, x @ coefficients) for c, x in own.columns.items())]:
                added[c] = added.get(c, np.zeros(1)) + x
        seen[id(view)] = added
    return [seen[id(view)] for view in evidence.views]


def _with_rivals(
    evidence: ArmMotionEvidence, candidates: Candidates, best: Explained, second: Explained | None
) -> Attribution:
    """Add to every cause what would explain as much: rivals at its joint, and for a payload what takes its place."""
    terms, rivals, ranking = best.fit.terms, [], []
    alike = second is not None and _alike(evidence, best, second)
    of_joints = {_name(t): (found, i) for found in best.alone for i, t in enumerate(found.fit.terms)}
    for i, term in enumerate(terms):
        others = [t for j, t in enumerate(terms) if j != i]
        if _name(term) in of_joints:
            found, k = of_joints[_name(term)]
            own = [f.terms[-1] for f in found.rivals[k]]
            ranking.append(found.ranking[k])
        else:
            own = []
            ranking.append(())
        trials = [fit(evidence.data, [*others, candidates.term(t.effect, t.site, t.shape)]) for t in own]
        if alike and second is not None:
            taken = {t.key for t in terms}
            new = [t for t in second.fit.terms if t.key not in taken]
            kept = {t.key for t in second.fit.terms}
            if term.key not in kept:
                trials += [fit(evidence.data, [*others, t]) for t in new]
        rivals.append(tuple(trials))
    explained = tuple(without_term(evidence, best.fit, i).total - best.fit.total for i in range(len(terms)))
    return Attribution(best.fit, tuple(rivals), explained, tuple(ranking), len(evidence.nuisance))


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
