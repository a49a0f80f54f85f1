"""A fit seen as linear around its best point: coefficients, shape parameters and deviations within tolerance together.

One step of Gauss and Newton from there polishes a shape beyond the grid of its search. How the gradient scatters over
pieces of the data gives the covariance of all parameters (White 1982; Liang and Zeger 1986). There are three ways to
cut: by parts of the motion, which repeats share, and by excitations, since a law that is an idealisation wants another
size in each of them; and by runs, since the machine itself differs from run to run.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.fit.term import Term, make_term
from sher3_diagnosis.thresholds import PIECES

STEP = 0.01
"""Relative step of the derivative with respect to a shape parameter."""


@dataclass(frozen=True)
class Local:
    """The linear model around one term of a fit.

    Attributes:
        names: continuous shape parameters of the term, which follow its coefficients.
        own: columns of the term's coefficients, then of those shape parameters.
        information: (p, p) normal matrix of all columns, `prior`: (p,) precision known beforehand.
        scores: for each way to cut the data, (pieces, p) gradient of each piece.
    """

    names: tuple[str, ...]
    own: slice
    information: Array
    prior: Array
    scores: tuple[Array, ...]

    @cached_property
    def _inverse(self) -> Array:
        total = self.information + np.diag(self.prior)
        scale = np.sqrt(np.where(np.diag(total) > 0.0, np.diag(total), 1.0))
        return np.linalg.pinv(total / np.outer(scale, scale), rcond=1e-10, hermitian=True) / np.outer(scale, scale)

    @property
    def step(self) -> dict[str, float]:
        """Change of each shape parameter that one step of Gauss and Newton asks for."""
        change = self._inverse @ self.scores[0].sum(axis=0)
        start = self.own.stop - len(self.names)
        return dict(zip(self.names, map(float, change[start : self.own.stop]), strict=True))

    def noise(self, gradient: Array) -> float:
        """Return the standard error that noise at the floor and deviations within tolerance give a parameter.

        Args:
            gradient: (p_own,) of the parameter.
        """
        return float(np.sqrt(max(float(gradient @ self._direction(gradient)[self.own]), 0.0)))

    def scatter(self, gradient: Array) -> float:
        """Return the standard error of a parameter by its scatter over every way to cut the data.

        Args:
            gradient: (p_own,) of the parameter.
        """
        direction = self._direction(gradient)
        counts = (len(scores) for scores in self.scores)
        squares = (float(np.sum((scores @ direction) ** 2)) for scores in self.scores)
        return float(np.sqrt(sum(s * n / max(n - 1, 1) for s, n in zip(squares, counts, strict=True))))

    def _direction(self, gradient: Array) -> Array:
        out: Array = self._inverse[:, self.own] @ gradient
        return out


def local(evidence: Evidence, fit: Fit, index: int) -> Local:
    """Return the linear model around one term of a fit, on all channels that terms share with it and with each other.

    What one channel alone cannot tell from a load, another that carries the load may tell.
    """
    data, term = evidence.data, fit.terms[index]
    channels = _joined(fit, term.channels)
    members = [i for i, t in enumerate(fit.terms) if t.channels & channels]
    slopes = {name: _slope(evidence, fit, index, name) for name in _continuous(term)}
    widths = {i: fit.terms[i].width for i in members}
    order = [i for i in members if i != index]
    p = sum(widths.values()) + len(slopes)
    own = slice(p - widths[index] - len(slopes), p)
    information = np.zeros((p, p))
    parts: dict[tuple[str, int], Array] = defaultdict(lambda: np.zeros(p))
    runs: dict[int, Array] = defaultdict(lambda: np.zeros(p))
    whole: dict[str, Array] = defaultdict(lambda: np.zeros(p))
    for r, excitation in enumerate(evidence.excitations):
        for channel in sorted(channels & data.target[r].keys()):
            left, columns = data.target[r][channel].copy(), []
            for i in [*order, index]:
                left -= fit.terms[i].adds(r, channel, fit.of(i))
                columns.append(fit.terms[i].wide(r, channel, len(left)))
            columns += [s[r].get(channel, np.zeros(len(left)))[:, None] for s in slopes.values()]
            jacobian = np.hstack(columns)
            information += jacobian.T @ jacobian
            piece = _pieces(evidence, r, channel)
            for k in np.unique(piece):
                at = piece == k
                gradient = jacobian[at].T @ left[at]
                parts[excitation, int(k)] += gradient
                runs[r] += gradient
                whole[excitation] += gradient
    limited = [np.full(widths[i], float(np.isfinite(fit.terms[i].limit))) for i in [*order, index]]
    prior = np.concatenate([*limited, np.zeros(len(slopes))])
    scores = tuple(np.array(list(cut.values())) for cut in (parts, runs, whole))
    return Local(tuple(slopes), own, information, prior, scores)


def _joined(fit: Fit, channels: frozenset[Channel]) -> frozenset[Channel]:
    """Return channels with all others that terms of a fit share with them, directly or by further terms."""
    joined = channels.union(*(t.channels for t in fit.terms if t.channels & channels))
    return channels if joined == channels else _joined(fit, joined)


def _continuous(term: Term) -> list[str]:
    """Shape parameters that are no choice; one that is zero or infinite stays so."""
    names = [*term.effect.finer, *term.effect.polished]
    return [n for n in names if term.shape.get(n) and np.isfinite(term.shape[n])]


def _slope(evidence: Evidence, fit: Fit, index: int, name: str) -> list[dict[Channel, Array]]:
    """Derivative of what a term predicts with respect to a shape parameter, per run and channel."""
    term = fit.terms[index]
    step = STEP * term.shape[name]
    shapes = [{**term.shape, name: term.shape[name] + by} for by in (-step, step)]
    low, high = (make_term(evidence.data, term.effect, term.site, shape) for shape in shapes)
    best = fit.of(index)
    return [
        {c: np.asarray(high.adds(r, c, best) - low.adds(r, c, best)) / (2.0 * step) for c in run | high.samples[r]}
        for r, run in enumerate(low.samples)
    ]


def _pieces(evidence: Evidence, run: int, channel: Channel) -> NDArray[np.intp]:
    """Piece of its excitation that each standardised sample of a run lies in, (N,): repeats share them."""
    ok = evidence.data.residuals[run][channel].ok
    piece = (np.flatnonzero(ok) * PIECES) // len(ok)
    return np.repeat(piece, len(evidence.floors[run][channel]))
