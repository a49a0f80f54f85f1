"""Fitting effects to residuals: standardised least squares with an exact leave-one-run-out loss.

For a given shape an effect is linear in its coefficients. Leaving a run out of the normal equations is then a
subtraction, and the loss of every run under the coefficients of all others costs a small solve. No score of a fit
here was seen by that fit. Terms that share no channel do not see each other and are solved apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import accumulate, pairwise

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.fit.gram import products
from sher3_diagnosis.fit.solving import RIDGE, leave_one_out, loss_under, solve
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.term import Term, make_term

__all__ = ["RIDGE", "Fit", "Term", "fit", "make_term", "solve"]


@dataclass(frozen=True)
class Fit:
    """A set of terms fitted together.

    Attributes:
        coefficients: (p,) of all terms in order; `loro_coefficients`: (runs, p), each without its run.
        loss: per run and channel, sum of squares under the coefficients of the other runs (held out).
        parts: the fits of terms that share channels.
    """

    terms: tuple[Term, ...]
    coefficients: Array
    loro_coefficients: Array
    loss: dict[tuple[int, Channel], float]
    parts: tuple[_Part, ...]

    def _columns(self, index: int) -> slice:
        start = sum(t.width for t in self.terms[:index])
        return slice(start, start + self.terms[index].width)

    def of(self, index: int) -> Array:
        """Return the coefficients (p,) of one term."""
        return self.coefficients[self._columns(index)]

    def loro_of(self, index: int) -> Array:
        """Leave-one-run-out coefficients of one term, (runs, p)."""
        return self.loro_coefficients[:, self._columns(index)]

    def others(self, index: int) -> list[Term]:
        """Return the terms without one of them."""
        return [t for i, t in enumerate(self.terms) if i != index]

    @cached_property
    def total(self) -> float:
        """Held-out loss over all runs and channels."""
        return sum(self.loss.values())

    @property
    def cancelled(self) -> float:
        """The largest of what a term adds by itself over what all terms of its channels add together, rms."""
        return max((part.cancelled for part in self.parts), default=0.0)

    @property
    def admissible(self) -> bool:
        """Whether every term's fit is physically possible."""
        return all(t.effect.admissible(t.shape, self.of(i)) for i, t in enumerate(self.terms))


@dataclass(frozen=True)
class _Part:
    """The fit of terms that share channels, with their normal matrix (p, p) of all runs."""

    terms: tuple[Term, ...]
    coefficients: Array
    held_out: Array
    loss: dict[tuple[int, Channel], float]
    normal: Array

    @cached_property
    def cancelled(self) -> float:
        """The largest of what a term adds by itself over what all of them add, rms."""
        x, ends = self.coefficients, pairwise([0, *accumulate(t.width for t in self.terms)])
        own = max(float(x[a:b] @ self.normal[a:b, a:b] @ x[a:b]) for a, b in ends)
        return float(np.sqrt(max(own, 0.0) / max(float(x @ self.normal @ x), np.finfo(float).tiny)))


def fit(data: Standardised, terms: Sequence[Term]) -> Fit:
    """Fit all terms together and score every run with the coefficients of the others."""
    groups = connected(terms)
    parts = tuple(_part(data, tuple([terms[i] for i in members])) for members in groups)
    loss = dict(data.null_loss)
    for part in parts:
        loss.update(part.loss)
    if len(parts) == 1:
        return Fit(tuple(terms), parts[0].coefficients, parts[0].held_out, loss, parts)
    starts = [0, *accumulate(t.width for t in terms)]
    coefficients, held_out = np.zeros(starts[-1]), np.zeros((len(data.target), starts[-1]))
    for members, part in zip(groups, parts, strict=True):
        columns = [k for i in members for k in range(starts[i], starts[i + 1])]
        coefficients[columns], held_out[:, columns] = part.coefficients, part.held_out
    return Fit(tuple(terms), coefficients, held_out, loss, parts)


def connected(terms: Sequence[Term]) -> list[list[int]]:
    """Return the indices of terms in groups that share channels."""
    return _connected(tuple([t.channels for t in terms]))


@lru_cache(maxsize=1000)
def _connected(shown: tuple[frozenset[Channel], ...]) -> list[list[int]]:
    """Return the indices of sets of channels in groups that share some; a search asks for the same many times."""
    group: dict[Channel, list[int]] = {}
    apart: list[list[int]] = []
    for i, channels in enumerate(shown):
        touching = {id(found): found for c in channels if (found := group.get(c)) is not None}
        first, *others = touching.values() if touching else ([],)
        for members in others:
            first += members
            group.update((c, first) for k in members for c in shown[k])
        first.append(i)
        group.update((c, first) for c in channels)
        apart += [] if channels else [first]
    return [sorted(members) for members in (*apart, *{id(x): x for x in group.values()}.values())]


def _part(data: Standardised, terms: tuple[Term, ...]) -> _Part:
    """Fit terms that share channels; the same terms are fitted once."""
    key = tuple(id(t) for t in terms)
    if key not in data.fits:
        data.fits[key] = _fit_part(data, terms)
    found: _Part = data.fits[key]
    return found


def _fit_part(data: Standardised, terms: tuple[Term, ...]) -> _Part:
    pieces = {c: products(data, terms, c) for c in sorted({c for t in terms for c in t.channels})}
    limit = np.array([t.limit for t in terms for _ in range(t.width)], dtype=float)
    normal = sum([n for n, _, _ in pieces.values()], np.zeros((len(data.target), len(limit), len(limit))))
    right = sum([b for _, b, _ in pieces.values()], np.zeros((len(data.target), len(limit))))
    coefficients, held_out, total = leave_one_out(normal, right, limit)
    loss: dict[tuple[int, Channel], float] = {}
    for c, (a, b, energy) in pieces.items():
        per_run = enumerate(loss_under(held_out, a, b, energy).tolist())
        loss |= {(r, c): x for r, x in per_run if (r, c) in data.null_loss}
    return _Part(terms, coefficients, held_out, loss, total)
