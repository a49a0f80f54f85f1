"""Fitting effects to residuals: whitened least squares with an exact leave-one-run-out loss.

For a given shape an effect is linear in its coefficients. Leaving a run out of the normal equations is then a
subtraction, and the loss of every run under the coefficients of all others costs a small solve. No score of a fit
here was seen by that fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Effect, Shape, Signature
from sher3_diagnosis.whitened import Whitened

RIDGE = 1e-9
"""Relative ridge on the normal equations: keeps collinear columns solvable without moving well-posed fits."""


@dataclass(frozen=True)
class Term:
    """An effect at a site with a shape, evaluated on every run.

    Attributes:
        columns: per run and channel (N, p) whitened.
        fixed: per run and channel (N,) whitened.
        width: number of coefficients p.
    """

    effect: Effect
    site: str
    shape: Shape
    columns: list[dict[Channel, Array]]
    fixed: list[dict[Channel, Array]]
    width: int

    @property
    def key(self) -> tuple[str, str]:
        """Effect id and site."""
        return self.effect.id, self.site

    @cached_property
    def channels(self) -> frozenset[Channel]:
        """Channels the term touches."""
        return frozenset(c for part in (self.columns, self.fixed) for run in part for c in run)


def make_term(data: Whitened, effect: Effect, site: str, shape: Shape) -> Term:
    """Evaluate an effect's signature on every run."""
    columns: list[dict[Channel, Array]] = []
    fixed: list[dict[Channel, Array]] = []
    width = 0
    seen: dict[int, Signature] = {}  # blocks of one record share its view
    for r, view in enumerate(data.views):
        present = data.target[r].keys()
        if id(view) not in seen:
            seen[id(view)] = effect.signature(view, site, shape)
        signature = seen[id(view)]
        columns.append({c: data.flat(r, c, x) for c, x in signature.columns.items() if c in present})
        fixed.append({c: data.flat(r, c, x) for c, x in signature.fixed.items() if c in present})
        width = max([width, *(x.shape[1] for x in columns[-1].values())])
    return Term(effect, site, shape, columns, fixed, width)


@dataclass(frozen=True)
class Fit:
    """A set of terms fitted together.

    Attributes:
        coefficients: (p,) of all terms in order; `loro_coefficients`: (runs, p), each without its run.
        loss: per run and channel, sum of squares under the coefficients of the other runs (held out).
        covariance: (p, p) run-clustered (jackknife) covariance of the coefficients.
    """

    terms: tuple[Term, ...]
    coefficients: Array
    loro_coefficients: Array
    loss: dict[tuple[int, Channel], float]

    def of(self, index: int) -> Array:
        """Coefficients of one term."""
        start = sum(t.width for t in self.terms[:index])
        return self.coefficients[start : start + self.terms[index].width]

    def loro_of(self, index: int) -> Array:
        """Leave-one-run-out coefficients of one term, (runs, p)."""
        start = sum(t.width for t in self.terms[:index])
        return self.loro_coefficients[:, start : start + self.terms[index].width]

    @property
    def total(self) -> float:
        """Held-out loss over all runs and channels."""
        return sum(self.loss.values())

    @property
    def admissible(self) -> bool:
        """Whether every term's fit is physically possible."""
        return all(t.effect.admissible(t.shape, self.of(i)) for i, t in enumerate(self.terms))


def fit(data: Whitened, terms: Sequence[Term]) -> Fit:
    """Fit all terms together and score every run with the coefficients of the others."""
    runs = len(data.target)
    offsets = np.cumsum([0, *(t.width for t in terms)])
    p = int(offsets[-1])
    touched = {c for t in terms for c in t.channels}
    normal, right = np.zeros((runs, p, p)), np.zeros((runs, p))
    pieces: dict[tuple[int, Channel], tuple[Array, Array, float]] = {}
    for r in range(runs):
        for c in touched & data.target[r].keys():
            y = data.target[r][c]
            for t in terms:
                if c in t.fixed[r]:
                    y = y - t.fixed[r][c]
            x = np.zeros((len(y), p))
            for t, start in zip(terms, offsets[:-1], strict=True):
                if c in t.columns[r]:
                    x[:, start : start + t.columns[r][c].shape[1]] = t.columns[r][c]
            a, b, energy = x.T @ x, x.T @ y, float(y @ y)
            pieces[r, c] = (a, b, energy)
            normal[r] += a
            right[r] += b
    total, all_right = normal.sum(axis=0), right.sum(axis=0)
    beta = solve(total, all_right)
    held_out = np.array([solve(total - normal[r], all_right - right[r]) for r in range(runs)]).reshape(runs, p)
    loss = dict(data.null_loss)
    for (r, c), (a, b, energy) in pieces.items():
        h = held_out[r]
        loss[r, c] = max(0.0, energy - 2.0 * h @ b + h @ a @ h)
    return Fit(tuple(terms), beta, held_out, loss)


def solve(normal: Array, right: Array) -> Array:
    """Solve normal equations scaled to unit diagonal, with a tiny ridge; columns without data get zero."""
    if len(right) == 0:
        return np.zeros(0)
    scale = np.sqrt(np.diag(normal))
    alive = scale > 1e-12 * max(scale.max(), 1e-300)
    out = np.zeros(len(right))
    if alive.any():
        s = scale[alive]
        a = normal[np.ix_(alive, alive)] / np.outer(s, s)
        out[alive] = np.linalg.solve(a + RIDGE * np.eye(len(s)), right[alive] / s) / s
    return out
