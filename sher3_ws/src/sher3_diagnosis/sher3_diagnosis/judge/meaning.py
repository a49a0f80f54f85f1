"""Which causes say nothing: as simple as another, impossible, or of no use to data that they were not fitted to.

This is asked of every cause of a machine whose policy says so (`Policy.swept`), in one place, whatever found it. A law
that contains a simpler one and is no more than that is replaced by it; anything else that says nothing is left out,
even if its gap is open then: a gap without a name is an answer, a wrong name is none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.together import Left
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import within
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term
from sher3_diagnosis.judge.borne_out import closed_without
from sher3_diagnosis.verdict import Cause, Parameter
from sher3_diagnosis.words import place, quantity, range_text, words

LOST = "lost_motion"
"""Family of which nothing is wider than the travel, and no gap negative unless its page says so."""
PLACES = ("m", "rad")
"""Units of a place: no size in them is larger than the travel, such as the sag of a servo."""
HALF = 0.5
"""Factor of all coefficients that shows which parameters they scale."""
SPAN = 10.0
"""Factor between the ends of an interval beyond which not even the order of magnitude of a size is told."""
OPEN = "of unknown size"
"""What is said in the place of such a number."""
ALIKE = 1e-9
"""Relative difference of two numbers that are the same but for rounding."""


def without_empty(
    candidates: Candidates,
    attribution: Attribution,
    causes: Sequence[Cause],
    left: Left,
    carried: bool = False,
) -> Attribution:
    """Return the attribution without the causes that say nothing, or the same where each says something.

    Of one place the cause that explains least goes first: what it leaves may give the others their size. One whose
    size may be zero stays where it explains most of what is told of its place, or a gap opens without it: that it is
    there is told by what it closes wherever it was not fitted.

    Args:
        candidates: the evidence and the effects.
        attribution: of the evidence.
        causes: of the attribution, with their sizes.
        left: says which gaps are left under a fit.
        carried: whether one whose size may be zero stays in the fit without a name.
    """
    evidence, found, empty = candidates.evidence, attribution.fit, dict[str, int]()
    sized = dict(zip(attribution.causes, causes, strict=True))
    small = {i for i, c in sized.items() if may_be_zero(found.terms[i], found.of(i), c)}
    for i, cause in sized.items():
        worth = attribution.explained[i]
        idle = i in small and (carried or not _explains_most(evidence, attribution, i, left))
        if idle or says_nothing(evidence, found, i, cause):
            other = empty.setdefault(cause.actuator, i)
            empty[cause.actuator] = i if worth < attribution.explained[other] else other
    for i in empty.values():
        if (fewer := _plainer(candidates, attribution, i)) is not None:
            return fewer
    if carried and (nameless := small & set(empty.values())):
        return _made_nuisance(evidence, attribution, sorted(nameless))
    for i in sorted(empty.values(), reverse=True):
        attribution = _simpler(candidates, attribution, i)
    return attribution


def _explains_most(evidence: Evidence, attribution: Attribution, index: int, left: Left) -> bool:
    """Return whether a cause explains most of what is told of its place, or a gap opens without it."""
    terms, worth = attribution.fit.terms, attribution.explained
    beside = sum(worth[k] for k in attribution.causes if k != index and terms[k].site == terms[index].site)
    return worth[index] >= beside or closed_without(evidence, attribution, index, left) is None


def says_nothing(evidence: Evidence, found: Fit, index: int, cause: Cause) -> bool:
    """Return whether a cause is no more than a simpler one, cannot be, or closes nothing of data left out."""
    term = found.terms[index]
    idle = cause.closure.value <= 0.0 or (cause.closure.low is not None and cause.closure.low <= 0.0)
    simple = any(map(_holds_zero, _bounded(cause, term.effect.extends_by)))
    return idle or simple or impossible(evidence, term, found.of(index), cause)


def may_be_zero(term: Term, coefficients: Array, cause: Cause) -> bool:
    """Return whether each size of a cause may be zero.

    Args:
        term: of the fit.
        coefficients: (p,) of the term.
        cause: as quantified, with its intervals.
    """
    sizes = _bounded(cause, sizes_of(term, coefficients))
    return bool(sizes) and all(map(_holds_zero, sizes))


def _bounded(cause: Cause, names: Sequence[str]) -> list[Parameter]:
    """Return those of some parameters of a cause that have an interval."""
    told = (cause.parameters[n] for n in names if n in cause.parameters)
    return [p for p in told if p.low is not None and p.high is not None]


def without_open_sizes(attribution: Attribution, causes: Sequence[Cause]) -> list[Cause]:
    """Return the causes of an attribution; sizes known to no factor of `SPAN` are told as unknown, with their interval.

    Of sizes that may all be zero the most is told alone. The cause stays: that there is a lag may be certain where its
    time is not.
    """
    out = []
    for i, cause in zip(attribution.causes, causes, strict=True):
        term, coefficients = attribution.fit.terms[i], attribution.fit.of(i)
        sizes = sizes_of(term, coefficients)
        told = {n: p.model_copy(update={"means": OPEN}) for n, p in cause.parameters.items() if n in sizes and _open(p)}
        if may_be_zero(term, coefficients, cause):
            told |= {n: _at_most(p) for n, p in cause.parameters.items() if n in sizes and _bounded(cause, [n])}
        out.append(cause.model_copy(update={"parameters": {**cause.parameters, **told}}))
    return out


def _at_most(p: Parameter) -> Parameter:
    """Return a size that may be zero without an interval, but with what it is at most."""
    most = quantity(max(abs(p.low or 0.0), abs(p.high or 0.0)), p.unit)
    return p.model_copy(update={"means": f"{OPEN}, at most {most}", "low": None, "high": None})


def open_sizes(attribution: Attribution, causes: Sequence[Cause]) -> list[str]:
    """Say of each size that is told as unknown how far it is open, and what would tell it."""
    return [
        f"{words(c.effect)} on {place(c.actuator)}: its {n.replace('_', ' ')} is "
        f"{p.means}{'' if p.low is None else f' ({range_text(p.low, p.high, p.unit)})'}; "
        f"what would tell it: {attribution.fit.terms[i].effect.best.why}"
        for i, c in zip(attribution.causes, causes, strict=True)
        for n, p in c.parameters.items()
        if (p.means or "").startswith(OPEN)
    ]


def _open(p: Parameter) -> bool:
    """Return whether an interval on one side of zero leaves the order of magnitude open."""
    if p.low is None or p.high is None or _holds_zero(p):
        return False
    least, most = sorted((abs(p.low), abs(p.high)))
    return most > SPAN * least


def sizes_of(term: Term, coefficients: Array) -> list[str]:
    """Return the parameters of how much of an effect there is: what all coefficients (p,) scale; without any, all.

    All of them too where the shape alone does something: a dead time stays where the lag behind it is none. An effect
    that is there by a choice, such as a frame, has none: its coefficients are what is beyond that choice.
    """
    if term.effect.discrete and any(term.fixed):
        return []
    whole, half = _scaled(term, coefficients, 1.0), _scaled(term, coefficients, HALF)
    alone = not len(coefficients) or any(term.fixed)
    return [n for n, x in whole.items() if alone or not math.isclose(half[n], x, rel_tol=ALIKE)]


def linear_in(term: Term, coefficients: Array) -> list[str]:
    """Return the parameters of a cause that are in proportion to its coefficients (p,)."""
    whole, half = _scaled(term, coefficients, 1.0), _scaled(term, coefficients, HALF)
    return [n for n, x in whole.items() if len(coefficients) and math.isclose(half[n], HALF * x, rel_tol=ALIKE)]


def _scaled(term: Term, coefficients: Array, factor: float) -> dict[str, float]:
    return term.effect.parameters(term.shape, factor * np.asarray(coefficients))


def impossible(evidence: Evidence, term: Term, coefficients: Array, cause: Cause) -> bool:
    """Return whether an end of an interval lies where no value can: beyond what its page says, or beyond the travel.

    Args:
        evidence: that was fitted.
        term: of the fit.
        coefficients: (p,) of the term.
        cause: as quantified, with its intervals.
    """
    limits = dict(term.effect.limits(term.shape))
    travel, sizes = _travel(evidence, term.site), linear_in(term, coefficients)
    for name, p in cause.parameters.items():
        wide = term.effect.family == LOST and term.effect.units.get(name) == "m"
        if wide or (name in sizes and evidence.own_unit(p.unit, term.site) in PLACES):
            limits[name] = (limits.get(name, (0.0 if wide else -travel, travel))[0], travel)
    return not within(limits, {name: _values_of(p) for name, p in cause.parameters.items()})


def _travel(evidence: Evidence, site: str) -> float:
    """Return how far an axis and its gap move at most, m or rad; infinite for a place that is no axis.

    A load encoder moves beside a motor that is held.
    """
    moved = list[float]()
    for view, residuals in zip(evidence.views, evidence.data.residuals, strict=True):
        motion = view.motion(site)
        if motion is not None and len(motion.position):
            beside = [x.values for c, x in residuals.items() if c.actuator == site and evidence.units[c] in PLACES]
            moved.append(float(np.ptp(motion.position)) + max((float(np.ptp(x)) for x in beside), default=0.0))
    return max(moved, default=math.inf)


def _values_of(p: Parameter) -> list[float]:
    return [x for x in (p.low, p.value, p.high) if x is not None]


def _holds_zero(p: Parameter) -> bool:
    assert p.low is not None and p.high is not None
    return p.low <= 0.0 <= p.high


def _made_nuisance(evidence: Evidence, attribution: Attribution, indices: Sequence[int]) -> Attribution:
    """Return the attribution with some of its causes among the terms that are none."""
    rest = [i for i in attribution.causes if i not in indices]
    put = attribution.arranged(evidence, [*range(attribution.nuisance), *indices, *rest])
    return replace(put, nuisance=attribution.nuisance + len(indices))


def _plainer(candidates: Candidates, attribution: Attribution, index: int) -> Attribution | None:
    """Return the attribution with a cause of the same effect in fewer numbers; None where its page has none.

    Two numbers that change places have no size each, and one of them alone has one.
    """
    terms = attribution.fit.terms
    found = candidates.best_plainer(terms[index], attribution.fit.others(index))
    if found is None:
        return None
    return attribution.arranged(candidates.evidence, range(len(terms)), {index: found.terms[-1]})


def _simpler(candidates: Candidates, attribution: Attribution, index: int) -> Attribution:
    """Return the attribution with the best simpler law in the place of a cause, or the best of its rivals there.

    Without the cause where there is neither.
    """
    found, evidence = attribution.fit, candidates.evidence
    term = found.terms[index]
    others = found.others(index)
    beside = {t.effect.id for t in others if t.site == term.site}
    plain = [e for e in candidates.effects if e.id in term.effect.extends and e.id not in beside]
    trials = [f for e in plain if (f := candidates.best(e, term.site, others)) is not None]
    trials = trials or [f for f in attribution.rivals[index] if f.terms[-1].site == term.site]
    if not trials:
        return attribution.kept(evidence, [i for i in attribution.causes if i != index])
    simpler = min(trials, key=lambda f: f.total).terms[-1]
    return attribution.arranged(evidence, range(len(found.terms)), {index: simpler})
