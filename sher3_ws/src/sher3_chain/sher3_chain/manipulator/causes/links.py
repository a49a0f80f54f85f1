"""Links whose inertial parameters are wrong, taken together: which of them, and which of their parameters are told.

A rough model has several wrong links, and what each does to the joints is spread over all of them: taken joint by
joint it looks like cables, waves and wrong gains. Here links enter by what they are worth, each with the parameters
that the motion tells beside those of the links before it and beside plain laws of every joint, and are then pruned
by what they explain of parts that were left out.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from sher3_diagnosis.attribute.candidates import price
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Effect, Measured, Shape
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term, fit, make_term
from sher3_diagnosis.fit.gram import products
from sher3_diagnosis.fit.solving import solve
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.term import again
from sher3_diagnosis.quantify.jackknife import standard_error
from sher3_diagnosis.thresholds import JACKKNIFE, NEEDED, PRICE
from sher3_diagnosis.verdict import Cause
from sher3_effects import pages

from sher3_chain.manipulator.causes.confounding import in_step
from sher3_chain.manipulator.evidence import ArmMotionEvidence, channel_of
from sher3_chain.manipulator.model import PARAMETERS, ArmModel
from sher3_chain.manipulator.rigid.physical import can_exist
from sher3_chain.thresholds import CONFOUNDED

CLEARLY = 0.5
"""Mean square over that before, of the joints that they load alike, up to which wrong links are the better explanation.

A rigid body has ten numbers, and what a joint does by itself is partly like one.
"""
ROUNDS = 3
"""Rounds in which what is left of each joint is its weight, first by plain laws alone, then beside links."""
OF_A_SUM = "in a sum over links"
"""What stands for a number of a link that no body has: the motion tells base parameters, sums over several links."""
OTHER_ROBOT = "the model may be that of another robot"
"""How the note begins that links are not as modelled."""
Law = tuple[Effect, str, Shape]


def other_robot_notes(causes: Sequence[Cause]) -> list[str]:
    """Return a sentence on links that differ from their model at any time: what wears is a joint, never a body."""
    of_links = {e.id for e in pages("joint") if any(x.startswith("link") for x in e.on_axis.values())}
    wrong = {c.actuator for c in causes if c.effect in of_links and c.condition is None}
    if not wrong:
        return []
    said = f"mass, centre or inertia of {', '.join(sorted(wrong))} differ, which no wear changes"
    return [f"{OTHER_ROBOT}: {said}; give the model of this robot, with what is mounted on it"]


def wrong_links(
    evidence: ArmMotionEvidence, page: Effect, laws: Sequence[Law], others: Sequence[Fit] = ()
) -> list[Law]:
    """Return the links that are worth their numbers beside plain laws of every joint, with what was found of them.

    None where they do not leave clearly less than the plain laws alone, or than one of the `others`; nor where the
    joints moved in step: the numbers of several links then cancel.

    Args:
        evidence: of the arm.
        page: of the inertial parameters of a link, found beforehand.
        laws: plain ones of every joint, with their places and shapes.
        others: fits that explain as well, with fewer numbers.
    """
    free = page.free()
    if free is None or in_step(evidence):
        return []
    left = level(evidence, fit(evidence.data, _terms(evidence, laws)))
    for i in range(ROUNDS):
        alike = balanced(evidence, left)
        plain = _terms(alike, laws)
        found = worthy(alike, [*plain, *_entered(alike, free, plain)])
        after = {c: max(left[c], 1.0) * x for c, x in level(alike, found).items()}
        if i == 0 and not _far_less(after, left, loaded_by(found, page)):
            return []
        left = after
    if not all(_far_less(left, level(evidence, other), loaded_by(found, page)) for other in others):
        return []
    found = _sized(alike, found, page)
    at = [i for i, term in enumerate(found.terms) if term.effect.id == page.id]
    return [(page, found.terms[i].site, page.found(_measured(found, i))) for i in at]


def as_sum(cause: Cause, term: Term, model: ArmModel) -> Cause:
    """Return a cause with its numbers as those of a sum where the link that it sits on cannot have them by itself."""
    if term.effect.free() is None:
        return cause
    names, first = term.effect.gives, PARAMETERS * model.links.index(term.site)
    change = np.array([term.shape.get(name, 0.0) for name in names])
    if can_exist(model.inertial[first : first + PARAMETERS] + change):
        return cause
    each = cause.parameters.items()
    sums = {n: p.model_copy(update={"means": OF_A_SUM}) if n in names else p for n, p in each}
    return cause.model_copy(update={"parameters": sums})


def worthy(evidence: Evidence, terms: Sequence[Term]) -> Fit:
    """Return the fit without the terms that parts left out have no use for, the last one first."""
    found = fit(evidence.data, terms)
    for term in reversed(terms):
        fewer = fit(evidence.data, [t for t in found.terms if t is not term])
        found = fewer if fewer.total - price(term) < found.total else found
    return found


def loaded_by(found: Fit, page: Effect) -> set[Channel]:
    """Return the force balances that the links of a fit, the terms of a page, load."""
    return {c for term in found.terms if term.effect.id == page.id for c in term.channels}


def _far_less(after: Mapping[Channel, float], before: Mapping[Channel, float], at: Collection[Channel]) -> bool:
    """Return whether mean squares in floors fell clearly, in the mean of their logarithms over some joints."""
    falls = [np.log(max(after[c], 1.0) / max(before[c], 1.0)) for c in before if c in at]
    return bool(falls) and bool(np.mean(falls) < np.log(CLEARLY))


def _terms(evidence: Evidence, laws: Sequence[Law]) -> list[Term]:
    return [*again(evidence.data, evidence.nuisance), *(make_term(evidence.data, *law) for law in laws)]


def level(evidence: Evidence, found: Fit) -> dict[Channel, float]:
    """Return the mean square that a fit leaves of every force balance, in floors."""
    out: dict[Channel, float] = {}
    for channel in map(channel_of, evidence.places["axis"]):
        if number := evidence.samples(channel):
            out[channel] = evidence.loss(channel, found) / number
    return out


def balanced(evidence: ArmMotionEvidence, left: Mapping[Channel, float]) -> Evidence:
    """Return the force balances over what is left of each: joints count alike, however quiet their efforts are."""
    data = evidence.data
    floors = [{c: x * max(left[c], 1.0) ** 0.5 for c, x in found.items() if c in left} for found in data.floors]
    residuals = [{c: x for c, x in found.items() if c in left} for found in data.residuals]
    return replace(evidence, data=Standardised(data.views, residuals, floors), nuisance=())


def _measured(found: Fit, index: int) -> dict[str, Measured]:
    """Return the parameters of a term with their standard errors, by fits without one part each."""
    each = zip(found.terms[index].shape, found.of(index), found.loro_of(index).T, strict=True)
    return {name: Measured(float(x), float(standard_error(without))) for name, x, without in each}


def _sized(evidence: Evidence, found: Fit, page: Effect) -> Fit:
    """Return a fit of links without the numbers whose intervals hold zero."""
    terms = list[Term]()
    for i, term in enumerate(found.terms):
        if term.effect.id != page.id:
            terms.append(term)
        elif sized := {n: 1.0 for n, x in _measured(found, i).items() if abs(x.value) > JACKKNIFE * x.error}:
            terms.append(make_term(evidence.data, term.effect, term.site, sized))
    return fit(evidence.data, terms)


def _entered(evidence: Evidence, page: Effect, plain: Sequence[Term]) -> list[Term]:
    """Return the terms of the links by what they are worth, the first of most, while one is worth its numbers."""
    names = page.gives
    every = {link: make_term(evidence.data, page, link, dict.fromkeys(names, 1.0)) for link in evidence.places["link"]}
    whole = {link: term for link, term in every.items() if term.channels}  # what no judged joint carries shows nowhere
    normal, right = _normal(evidence, [*plain, *whole.values()])
    columns = list(range(sum(t.width for t in plain)))
    first = {link: len(columns) + len(names) * i for i, link in enumerate(whole)}
    worth, taken = _worth(normal, right, columns), dict[str, list[int]]()
    while len(taken) < len(whole):
        columns_of = {
            link: _identifiable(normal, columns, at, len(names)) for link, at in first.items() if link not in taken
        }
        gains = {link: _worth(normal, right, [*columns, *new]) for link, new in columns_of.items()}
        best = max(gains, key=lambda link: gains[link])
        if gains[best] - worth < NEEDED:
            break
        taken[best], worth = columns_of[best], gains[best]
        columns += columns_of[best]
    shapes = {link: {names[i - first[link]]: 1.0 for i in new} for link, new in taken.items()}
    return [make_term(evidence.data, page, link, shape) for link, shape in shapes.items()]


def _normal(evidence: Evidence, terms: Sequence[Term]) -> tuple[Array, Array]:
    """Return the normal equations of all terms over all channels, (p, p) and (p,)."""
    found = [products(evidence.data, tuple(terms), c) for c in sorted({c for t in terms for c in t.channels})]
    return np.sum([n.sum(axis=0) for n, _, _ in found], axis=0), np.sum([b.sum(axis=0) for _, b, _ in found], axis=0)


def _worth(normal: Array, right: Array, columns: Sequence[int]) -> float:
    """Return the loss that columns explain, less the price of their numbers."""
    at = np.array(columns, dtype=int)
    return float(right[at] @ solve(normal[np.ix_(at, at)], right[at])) - PRICE * len(at)


def _identifiable(normal: Array, columns: Sequence[int], first: int, count: int) -> list[int]:
    """Return those of `count` columns of a link of which enough is left beside others and those before them."""
    kept: list[int] = []
    for j in range(first, first + count):
        beside = np.array([*columns, *kept], dtype=int)
        length = normal[j, j]
        left = length - normal[j, beside] @ solve(normal[np.ix_(beside, beside)], normal[beside, j])
        if length > 0.0 and left > CONFOUNDED**2 * length:
            kept.append(j)
    return kept
