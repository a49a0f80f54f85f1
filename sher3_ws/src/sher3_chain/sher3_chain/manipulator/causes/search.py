"""How the causes of a serial arm are looked for: joint by joint, without and with a payload that all joints carry.

What a joint does alone is a matter of its own force balance. A payload shows on several joints at once; it is taken
where it and what the joints then still need are cheaper than what the joints need without it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from sher3_common.progress import Say
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.plan import SearchPlan
from sher3_diagnosis.attribute.planned import planned
from sher3_diagnosis.attribute.polish import polished
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term, fit, make_term
from sher3_diagnosis.fit.tolerance import NUISANCE
from sher3_diagnosis.judge.left_over import down_to_floor
from sher3_diagnosis.thresholds import NEEDED
from sher3_effects import computed

from sher3_chain.manipulator.causes.confounding import GAIN
from sher3_chain.manipulator.causes.explained import Explained, with_rivals
from sher3_chain.manipulator.causes.lateness import LATE, OF_LAW, Late, lateness
from sher3_chain.manipulator.causes.links import CLEARLY, wrong_links
from sher3_chain.manipulator.causes.payload import beside, centred, closes, middle, payloads
from sher3_chain.manipulator.causes.plan import BESIDE_LINKS, JOINT, TOGETHER, bought, laws_beside_links, spent
from sher3_chain.manipulator.evidence import ArmMotionEvidence, between, channel_of, select_channel
from sher3_chain.search.friction_in_motion import without_slow

BODILY = {"acceleration", "position"}
"""Inputs of a joint's own laws that a rigid body has too."""
TIMING = "timing"
"""Family of what is late."""


def causes_of_arm(evidence: ArmMotionEvidence, candidates: Candidates, say: Say) -> Attribution:
    """Choose the causes of an arm in motion, with their rivals; none where no joint has a gap.

    A load that one joint alone feels is taken where that joint's own laws leave clearly more. None is looked for where
    links with other bodies leave far less beside plain laws, but for what single joints may do that costs clearly less.
    """
    if not down_to_floor(evidence.channels, evidence, evidence.null()):
        return Attribution(evidence.null(), (), (), nuisance=len(evidence.nuisance))
    best, others = _explained(evidence, candidates, (), None, say), list[Explained]()
    plain = beside(evidence, candidates)
    loads = payloads(evidence, candidates, plain)
    linked = _linked(evidence, candidates, [fit(evidence.data, plain), *(load.fit for load in loads)], say)
    if linked is not None and CLEARLY * linked.cost < best.cost:
        return with_rivals(evidence, candidates, linked, ())
    for load in loads:
        other = _explained(evidence, candidates, load.fit.terms[-1:], load.fit, say)
        better = other.cost < (1.0 if load.felt else CLEARLY) * best.cost and closes(evidence, other.fit)
        best, others = (other, [*others, best]) if better else (best, [*others, other])
    return with_rivals(evidence, candidates, best, others)


def _linked(evidence: ArmMotionEvidence, candidates: Candidates, others: Sequence[Fit], say: Say) -> Explained | None:
    """Return the causes beside links with wrong inertial parameters; None where fewer numbers, `others`, do as well.

    The links are found beside plain laws of the joints, then what each joint has beside them, then the links again: a
    law that no joint needs by itself has no part in them.
    """
    page = next((e for e in candidates.effects if e.free() is not None), None)
    if page is None:
        return None
    plain = [e for e in candidates.effects if e.plain and e.scales != GAIN and not BODILY & set(e.inputs)]
    laws = [(e, j, middle(e, evidence, j)) for j in evidence.judged for e in plain if e.shapes(evidence.views, j)]
    links = wrong_links(evidence, page, laws, others)
    if not links:
        return None
    loads = [candidates.term(*link) for link in links]
    found = _explained(evidence, candidates, loads, fit(evidence.data, loads), say)
    first = len(evidence.nuisance)
    joints = found.fit.terms[first + len(loads) :]
    again = wrong_links(evidence, page, [(t.effect, t.site, t.shape) for t in joints]) or links
    whole = fit(evidence.data, [*evidence.nuisance, *(candidates.term(*link) for link in again), *joints])
    return min(found, replace(found, fit=bought(evidence, whole, first + len(again))), key=lambda x: x.cost)


def _explained(
    evidence: ArmMotionEvidence, candidates: Candidates, loads: Sequence[Term], loaded: Fit | None, say: Say
) -> Explained:
    """Search every joint for causes beside `loads` on links, as `loaded` has them, and fit all of them together.

    What lies between two encoders says nothing of a force balance, since the links move as their own encoders say.
    """
    effects = [e for e in candidates.effects if e.places == ("axis",)]
    beside = _added(evidence, loaded, loads) if loaded is not None else ()
    linked = any(t.effect.free() is not None for t in loads)
    effects = laws_beside_links(effects) if linked else effects
    alone: list[Attribution] = []
    for channel in (c for joint in evidence.judged for c in (channel_of(joint), between(joint))):
        own = select_channel(evidence, channel, beside)
        say(f"{channel}{' beside ' + ' and '.join(t.site for t in loads) if loads else ''}")
        balance = channel == channel_of(channel.actuator)
        late = lateness(evidence, channel.actuator, beside) if balance else None
        by_law = evidence.records[0].axis(channel.actuator).follows
        plans = (BESIDE_LINKS,) if linked else (TOGETHER,) if loads else (JOINT, TOGETHER) if by_law else (JOINT,)
        alone.append(_beside_delay(own, late, effects, say, plans) if balance else _searched(own, effects, say))
    terms = [*evidence.nuisance, *loads]
    for found in alone:
        terms += [candidates.term(t.effect, t.site, t.shape) for t in found.fit.terms if t.effect.family != NUISANCE]
    whole, first = fit(evidence.data, terms), len(evidence.nuisance)
    for at in range(first, first + len(loads)):
        whole = centred(candidates, whole, at)
    return Explained(bought(evidence, whole, first + len(loads)), alone)


def _searched(
    own: Evidence, effects: Sequence[Effect], say: Say, plans: Sequence[SearchPlan] = (JOINT,)
) -> Attribution:
    """Search one channel for causes by each plan; return the cheapest."""
    left = partial(down_to_floor, own.channels, own)
    found = [polished(own, planned(Candidates(own, effects), plan, left, say)) for plan in plans]
    return min(found, key=lambda attribution: spent(attribution.fit))


def _beside_delay(
    own: Evidence, late: Late | None, effects: Sequence[Effect], say: Say, plans: Sequence[SearchPlan]
) -> Attribution:
    """Search the force balance of a joint without and beside a late effort; return what is cheaper.

    The delay is told by its shape: causes may be at the floor without it, and a fit would take up a viscous friction or
    how a dry one turns. Where the shape tells none, none is looked for; one within the doubt of the record's own clock
    is looked for only in what is left, since laws fitted at once would share it. They are compared away from reversals,
    where a dry friction is no matter of a moment.
    """
    others = [e for e in effects if e.family != TIMING or e.id == computed(OF_LAW).id]
    if late is not None and late.significant and not late.sure:
        return _searched(own, effects, say, [replace(plan, together=False) for plan in plans])
    found = _searched(own, others, say, plans)
    if late is None or not late.sure:
        return found
    site = own.places["axis"][0]
    page = computed(LATE).at_estimate()
    trials = [make_term(own.data, page, site, shape) for shape in late.shapes]
    best = min(trials, key=lambda term: fit(own.data, [*found.fit.terms, term]).total)
    beside = _searched(replace(own, nuisance=(best,)), others, say, plans)
    return beside if beside.fit.admissible and _worth(own, site, found.fit, beside.fit) > NEEDED else found


def _worth(own: Evidence, site: str, without: Fit, beside: Fit) -> float:
    """Return by how much a fit lowers the loss away from reversals, in units of what it leaves there.

    The floor of an arm counts the noise of all encoders at their worst; a delay shows in what is really left.
    """
    away = without_slow(own, {site}).data
    again = ([make_term(away, t.effect, t.site, t.shape) for t in found.terms] for found in (without, beside))
    first, second = (fit(away, terms).total for terms in again)
    return (first - second) * sum(away.samples.values()) / max(second, 1.0)


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
