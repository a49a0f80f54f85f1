"""What changed between conditions: terms that act in some runs alone, beside causes that are common to all.

The common causes are chosen on the runs of the reference, so that no change can pass for one of them. Then changes are
added one by one while each is worth its price; common causes are fitted again with them, on all runs. An effect that
explains as much when it acts in all runs alike is no change: the reference left it out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from sher3_diagnosis.attribute.candidates import Candidates, complexity, cost, possible
from sher3_diagnosis.attribute.rivals import Attribution, without_term
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Effect, Shape, Signature
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term, fit, make_term
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.term import again
from sher3_diagnosis.thresholds import NEEDED, PARSIMONY, RIVAL
from sher3_diagnosis.words import lower, place, quantity

from sher3_chain.joint.conditions import Condition
from sher3_chain.thresholds import CHANGES

E = TypeVar("E", bound=Evidence)
Finish = Callable[[Candidates, Fit], Fit]
"""Improves the fit of a change beyond its search: the inertia of a payload about its own centre, for one."""

SAME_AS_ALWAYS = (
    *("id", "family", "stage", "explanation", "places", "units"),
    *("companion", "shown_by", "dry", "slow", "best"),
)
"""Attributes of a page that hold for the effect under a condition as well."""


class Changed(Effect):
    """An effect that acts under one condition alone, beside the same effect as all runs have it.

    Attributes:
        of: the effect.
        condition: it acts under, in words; `views`: of its runs, by identity.
        common: shape and coefficients that all runs have of it, where they have it.
    """

    def __init__(self, of: Effect, condition: Condition, views: frozenset[int], common: Common | None) -> None:
        self.of, self.views, self.common = of, views, common
        self.condition = str(condition)
        for name in SAME_AS_ALWAYS:
            setattr(self, name, getattr(of, name))

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return those of the effect."""
        return self.of.channels(site)

    def shapes(self, views: Sequence[Any], site: str) -> list[Shape]:
        """Return the shapes of the effect under its condition; the common one where all runs have it."""
        return [self.common.shape] if self.common else self.of.shapes([v for v in views if id(v) in self.views], site)

    def refine(self, shape: Shape) -> list[Shape]:
        """Return the neighbours of a shape that is not common."""
        return [] if self.common else self.of.refine(shape)

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return what the effect adds under its condition, nothing elsewhere."""
        found = self.of.signature(view, site, shape)
        if id(view) in self.views:
            return found
        return Signature({c: 0.0 * x for c, x in found.columns.items()}, {c: 0.0 * x for c, x in found.fixed.items()})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the change of the parameters for coefficients (p,), SI units."""
        return self.of.parameters(shape, coefficients)

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether common part and change together, coefficients (p,), are physically possible."""
        together = coefficients + self.common.coefficients if self.common else coefficients
        return self.of.admissible(shape, together)

    def allowed(self, views: Sequence[Any], site: str, shape: Shape) -> bool:
        """Return whether the runs can hold a shape of the effect."""
        return self.of.allowed(views, site, shape)

    def unit(self, name: str, site: str, rotary: bool) -> str:
        """Return the unit of a parameter of the effect."""
        return self.of.unit(name, site, rotary)

    def stage_at(self, channel: Channel) -> str:
        """Return the stage of the effect."""
        return self.of.stage_at(channel)


@dataclass(frozen=True)
class Common:
    """A cause that all runs have."""

    shape: Shape
    coefficients: Array


def select_runs(evidence: E, views: frozenset[int]) -> E:
    """Return the evidence of some runs alone, given by the identity of their views."""
    data = evidence.data
    kept = [r for r, view in enumerate(data.views) if id(view) in views]
    part = Standardised(
        [data.views[r] for r in kept], [data.residuals[r] for r in kept], [data.floors[r] for r in kept]
    )
    names, nuisance = [evidence.excitations[r] for r in kept], again(part, evidence.nuisance)
    return replace(evidence, excitations=names, data=part, nuisance=nuisance)


def contrasted(
    evidence: Evidence,
    common: Attribution,
    effects: Sequence[Effect],
    conditions: Sequence[tuple[Condition, frozenset[int]]],
    finish: Finish = lambda _, found: found,
) -> Attribution:
    """Add to the causes of the reference what changed under the other conditions.

    Args:
        evidence: of all runs.
        common: causes of the runs of the reference.
        effects: that may have changed.
        conditions: each with the identities of the views of its runs.
        finish: improves the fit of a change.
    """
    kept = list(again(evidence.data, common.fit.terms))
    current, rivals = fit(evidence.data, kept), [_again(evidence, kept, i, common.rivals) for i in range(len(kept))]
    for _ in range(CHANGES):
        trials = [t for c, views in conditions for t in _trials(evidence, current, effects, c, views, finish)]
        if not trials:
            break
        best = _prefer_common(evidence, current, min(trials, key=cost))
        worth = current.total - best.total
        if worth < NEEDED * complexity(best.terms[-1]) + PARSIMONY * _explained(evidence, best):
            break
        margin = max(NEEDED, RIVAL * worth)
        rivals.append(tuple(t for t in trials if t.total < best.total + margin and _other(t.terms[-1], best.terms[-1])))
        current = best
    explained = tuple(without_term(evidence, current, i).total - current.total for i in range(len(current.terms)))
    ranking = [_again(evidence, kept, i, common.ranking) for i in range(len(kept))]
    none = ((),) * (len(current.terms) - len(kept))
    return Attribution(current, tuple(rivals), explained, (*ranking, *none), common.nuisance)


def _prefer_common(evidence: Evidence, current: Fit, change: Fit) -> Fit:
    """Return the effect of a change in all runs alike, where the change is not worth its numbers more than that.

    What the reference is too short or too quiet to tell is no change: the other runs may show it for all.
    """
    last = change.terms[-1]
    if not isinstance(last.effect, Changed) or last.effect.common is not None:
        return change
    effect = last.effect.of
    shared = Candidates(evidence, [effect]).best(effect, last.site, current.terms)
    return shared if shared is not None and shared.total <= change.total + NEEDED else change


def _explained(evidence: Evidence, found: Fit, index: int = -1) -> float:
    """Return the loss that all causes explain where one of them shows; default the last."""
    null, shown = evidence.null().loss, found.terms[index].channels
    return sum(null[key] - loss for key, loss in found.loss.items() if key[1] in shown)


def _again(evidence: Evidence, kept: Sequence[Term], index: int, found: Sequence[Sequence[Fit]]) -> tuple[Fit, ...]:
    """Fit what was found in the place of a common cause to all runs; a search that found no cause has nothing there."""
    others = [t for j, t in enumerate(kept) if j != index]
    own = [f.terms[-1] for f in found[index]] if index < len(found) else []
    return tuple(fit(evidence.data, [*others, make_term(evidence.data, t.effect, t.site, t.shape)]) for t in own)


def _trials(
    evidence: Evidence,
    current: Fit,
    effects: Sequence[Effect],
    condition: Condition,
    views: frozenset[int],
    finish: Finish,
) -> list[Fit]:
    """Fit every effect at every site as a change under one condition."""
    have = {t.key: Common(t.shape, current.of(i)) for i, t in enumerate(current.terms) if t.effect.condition is None}
    taken = {t.key for t in current.terms if t.effect.condition == str(condition)}
    out = []
    for effect in effects:
        sites = [s for place in effect.places for s in evidence.places.get(place, ()) if (effect.id, s) not in taken]
        for site in sites:
            changed = Changed(effect, condition, views, have.get((effect.id, site)))
            candidates = Candidates(evidence, [changed])
            found = candidates.best(changed, site, current.terms)
            if found is None and effect.about:
                found = _begun(candidates, changed, site, current.terms)
            trial = None if found is None else finish(candidates, found)
            if trial is not None and possible(trial):
                out.append(trial)
    return out


def _begun(candidates: Candidates, effect: Effect, site: str, given: Sequence[Term]) -> Fit | None:
    """Return the fit with an effect in its first shape, about which it may not be possible yet; None without one."""
    evidence = candidates.evidence
    terms = [candidates.term(effect, site, shape) for shape in effect.shapes(evidence.views, site)[:1]]
    return fit(evidence.data, [*given, *terms]) if terms and terms[0].channels else None


def _other(a: Term, b: Term) -> bool:
    return a.effect.id != b.effect.id


def change_notes(
    evidence: Evidence, attribution: Attribution, conditions: Sequence[tuple[Condition, frozenset[int]]]
) -> list[str]:
    """Return in words what changed under each condition, or the least change of each cause that would have shown.

    Args:
        evidence: of all runs.
        attribution: of the causes and changes.
        conditions: each with the identities of the views of its runs.
    """
    out, sites = [], {c.actuator for c in evidence.channels}
    head = f"{place(next(iter(sites)))}: " if len(sites) == 1 else ""
    for condition, views in conditions:
        of = [i for i, t in enumerate(attribution.fit.terms) if t.effect.condition == str(condition)]
        said = [_in_words(evidence, attribution.fit, i) for i in of] or [_no_change_note(evidence, attribution, views)]
        out.append(f"{head}{condition} against {condition.reference}, all else held common: {'; '.join(said)}")
    return out


def _no_change_note(evidence: Evidence, attribution: Attribution, views: frozenset[int]) -> str:
    """Return that nothing changed, where that was looked at, and from which size on it would have shown."""
    stages = sorted({c.stage.replace("_", " ") for c in evidence.channels})
    least = [said for i in attribution.causes if (said := _least_change(evidence, attribution.fit, i, views))]
    power = f"; would have shown: {', '.join(least)}" if least else ""
    return f"nothing changed that the library knows in {' and '.join(stages)}{power}"


def _least_change(evidence: Evidence, found: Fit, index: int, views: frozenset[int]) -> str:
    """Return the change of a cause's sizes, all by one share, that would be worth its price under a condition.

    What the causes common to all runs take up of it does not show.
    """
    term, own = found.terms[index], found.of(index)
    keys = [(r, c) for r, run in enumerate(term.columns) for c in run]
    if not term.width or not keys:
        return ""
    acts = [id(evidence.views[r]) in views for r, _ in keys]
    change = np.concatenate([on * (term.columns[r][c] @ own) for on, (r, c) in zip(acts, keys, strict=True)])
    common = [
        np.concatenate([t.columns[r].get(c, np.zeros((len(term.columns[r][c]), t.width))) for r, c in keys])
        for t in found.terms
        if t.width
    ]
    x = np.hstack(common)
    left = change - x @ np.linalg.lstsq(x, change, rcond=None)[0]
    needed = NEEDED * complexity(term) + PARSIMONY * _explained(evidence, found, index)
    share = float(np.sqrt(needed / max(float(left @ left), np.finfo(float).tiny)))
    zero, moved = (term.effect.parameters(term.shape, own * (1.0 + s)) for s in (0.0, share))
    name = next((n for n in moved if moved[n] != zero[n]), None)
    if name is None:
        return ""
    size = float(f"{abs(moved[name] - zero[name]):.2g}")
    return f"{lower(term.effect.id)} on {place(term.site)}, {name} by {_sized(evidence, term, name, size)}"


def _in_words(evidence: Evidence, found: Fit, index: int) -> str:
    term = found.terms[index]
    values = term.effect.parameters(term.shape, found.of(index))
    fitted = [n for n in values if n not in term.shape] or list(values)
    sizes = [f"{n.replace('_', ' ')} {'+' * (values[n] > 0.0)}{_sized(evidence, term, n, values[n])}" for n in fitted]
    return f"{lower(term.effect.id)} on {place(term.site)}: {', '.join(sizes)}"


def _sized(evidence: Evidence, term: Term, name: str, value: float) -> str:
    """Return a parameter with its unit."""
    return quantity(
        value, evidence.own_unit(term.effect.unit(name, term.site, term.site in evidence.rotary), term.site)
    )
