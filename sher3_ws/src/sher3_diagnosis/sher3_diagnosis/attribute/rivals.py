"""Rivals: the effects that would explain as much in the place of a cause."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.ties import TIE, first_of_least
from sher3_diagnosis.channel import AT_TIP, Array
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.thresholds import NEEDED, RIVAL

RANKED = 6
"""Effects kept in the ranking of a cause, and tried in pairs."""


@dataclass(frozen=True)
class InMotion:
    """A fit where nothing rests.

    Attributes:
        evidence: without the samples at rest.
        fit: of the same terms, to that evidence.
        whole: the same laws and coefficients on all samples, with the loss of the fit to them.
    """

    evidence: Evidence
    fit: Fit
    whole: Fit


@dataclass(frozen=True)
class Attribution:
    """Chosen causes, jointly fitted, and for each the effects that explain as much; one entry per term of the fit."""

    fit: Fit
    rivals: tuple[tuple[Fit, ...], ...]
    explained: tuple[float, ...]
    """Loss that removing each term, and refitting the others, adds."""
    ranking: tuple[tuple[Fit, ...], ...] = ()
    """For each term the effects that come closest to it in its place, best first, itself among them."""
    nuisance: int = 0
    """Number of leading terms that are no causes."""
    steps: tuple[Fit, ...] = ()
    """Fits on the way to this one, where the effects were looked for in layers."""
    moving: InMotion | None = None
    """The fit where no friction rests, where a cause is one that does."""

    def arranged(self, evidence: Evidence, order: Sequence[int], new: Mapping[int, Term] | None = None) -> Attribution:
        """Return some of the terms in a new order, fitted again; the rivals of each term stay with it.

        Args:
            evidence: that the fit is of.
            order: indices of the terms.
            new: index -> the term in its place, of which no rivals are known.
        """
        new = new or {}
        if list(order) == list(range(len(self.fit.terms))) and not new:
            return self

        def of(found: tuple[tuple[Fit, ...], ...]) -> tuple[tuple[Fit, ...], ...]:
            return tuple(() if i in new else found[i] for i in order) if found else ()

        return replace(
            self,
            fit=fit(evidence.data, [new.get(i, self.fit.terms[i]) for i in order]),
            rivals=of(self.rivals),
            explained=tuple(self.explained[i] for i in order),
            ranking=of(self.ranking),
        )

    def kept(self, evidence: Evidence, causes: Sequence[int]) -> Attribution:
        """Return the attribution with some of its causes alone, given by their indices."""
        return self.arranged(evidence, [*range(self.nuisance), *causes])

    @property
    def causes(self) -> range:
        """Indices of the terms that are causes."""
        return range(self.nuisance, len(self.fit.terms))

    @property
    def named(self) -> list[tuple[Term, Array]]:
        """The term of each cause with its coefficients, (p,)."""
        return [(self.fit.terms[i], self.fit.of(i)) for i in self.causes]

    def ranked(self, index: int) -> tuple[tuple[Fit, ...], float]:
        """Return the ranking of a cause, and the total loss of the cause itself that it is to be compared with.

        A cause that was looked for in its own place was ranked there, where the losses of other places are in no total.
        """
        found = self.ranking[index] if self.ranking else ()  # a search by steps ranks none
        own = next((f.total for f in found if f.terms[-1].key == self.fit.terms[index].key), np.inf)
        return found, min(own, self.fit.total)


def without_term(evidence: Evidence, current: Fit, index: int) -> Fit:
    """Fit again without one term."""
    return fit(evidence.data, current.others(index))


def pruned_by(evidence: Evidence, current: Fit, worth: Callable[[Fit, int, Fit], bool]) -> Fit:
    """Return a fit without the causes that are worth nothing, the least missed first; at least one cause is kept.

    Args:
        evidence: that the fit is of.
        current: to be pruned; among causes missed equally, such as a drive's gain beside mass and weight, that one goes
            without which the next is missed least, the last chosen first.
        worth: whether a cause is to stay, given the fit with it, its index and the fit without it.
    """
    while len(current.terms) > len(evidence.nuisance) + 1:
        reduced = _reduced(evidence, current)
        least = min(f.total for f in reduced.values())
        tied = {i: f for i, f in reduced.items() if f.total <= least + TIE}
        i = next(iter(tied))
        if len(tied) > 1:
            i = first_of_least({i: min(g.total for g in _reduced(evidence, f).values()) for i, f in tied.items()})
        if worth(current, i, reduced[i]):
            break
        current = reduced[i]
    return current


def _reduced(evidence: Evidence, current: Fit) -> dict[int, Fit]:
    """Return the fits without each cause, the last chosen first."""
    causes = range(len(evidence.nuisance), len(current.terms))
    return {i: without_term(evidence, current, i) for i in reversed(causes)}


def with_rivals(candidates: Candidates, current: Fit) -> Attribution:
    """Add to a fit, for each of its causes, the effects that would explain as much in its place."""
    evidence = candidates.evidence
    rivals: list[tuple[Fit, ...]] = []
    explained: list[float] = []
    ranking: list[tuple[Fit, ...]] = []
    for i, term in enumerate(current.terms):
        others = current.others(i)
        worth = fit(evidence.data, others).total - current.total
        ranked = candidates.search(term.channels, others) if i >= len(evidence.nuisance) else []
        ranking.append(tuple(ranked[:RANKED]))
        alike = [f for f in ranked if unlikeness(f, current.total, worth) < 1.0]
        rivals.append(tuple(f for f in alike if f.terms[-1].effect.id != term.effect.id))
        explained.append(worth)
    return Attribution(current, tuple(rivals), tuple(explained), tuple(ranking), len(evidence.nuisance))


def unlikeness(rival: Fit, chosen: float, worth: float) -> float:
    """Return the normalised difference of a rival's loss to that of the chosen effect; below 1 it explains as much.

    The share is of the gap with its floor: rounding repeats, so that a small part of the floor is no evidence. At the
    tip there is none.
    """
    floor = sum(len(x) for run in rival.terms[-1].columns for c, x in run.items() if c.stage not in AT_TIP)
    margin = max(NEEDED, RIVAL * (worth + floor))
    return (rival.total - chosen) / margin
