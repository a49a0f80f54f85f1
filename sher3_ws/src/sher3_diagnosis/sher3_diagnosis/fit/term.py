"""A term of a fit: an effect at a site with a shape, evaluated on every run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Effect, Shape, Signature
from sher3_diagnosis.fit.rows import Rows
from sher3_diagnosis.fit.standardised import Standardised


@dataclass(frozen=True)
class Term:
    """An effect at a site with a shape, evaluated on every run.

    Attributes:
        columns: per run and channel (N, p) standardised.
        fixed: per run and channel (N,) standardised.
        width: number of coefficients p.
        limit: largest magnitude of a coefficient, in standard deviations: each is then expected to be normal with a
            standard deviation of one. Infinite for coefficients of which nothing is known beforehand.
        products: with other terms, kept by `sher3_diagnosis.fit.gram`.
        held: its rows by channel, kept by `rows`.
    """

    effect: Effect
    site: str
    shape: Shape
    columns: list[dict[Channel, Array]]
    fixed: list[dict[Channel, Array]]
    width: int
    limit: float = math.inf
    products: dict[Any, tuple[Any, Array]] = field(default_factory=dict, init=False, compare=False, repr=False)
    held: dict[Channel, Rows] = field(default_factory=dict, init=False, compare=False, repr=False)

    @property
    def key(self) -> tuple[str, str]:
        """Effect id and site."""
        return self.effect.id, self.site

    @cached_property
    def channels(self) -> frozenset[Channel]:
        """Channels the term touches."""
        return frozenset(c for part in (self.columns, self.fixed) for run in part for c in run)

    @cached_property
    def samples(self) -> list[dict[Channel, int]]:
        """Standardised samples per run and channel."""
        return [
            {c: len(v) for part in (x, f) for c, v in part.items()}
            for x, f in zip(self.columns, self.fixed, strict=True)
        ]

    def rows(self, channel: Channel) -> Rows:
        """Return columns and, last, the fixed part on a channel, (width + 1, N) of all runs, zeros where none is.

        From then on the columns are views of these rows.
        """
        if channel not in self.held:
            parts, samples, both = [], [], (self.columns, self.fixed)
            for run in zip(*both, strict=True):
                parts.append([(row, x[channel]) for row, x in zip((0, self.width), run, strict=True) if channel in x])
                samples.append(len(parts[-1][0][1]) if parts[-1] else 0)
            rows = self.held[channel] = Rows(parts, samples, self.width + 1)
            for x, begin, end in zip(self.columns, rows.ends[:-1], rows.ends[1:], strict=True):
                if channel in x:
                    x[channel] = rows.values[: x[channel].shape[1], begin:end].T
        return self.held[channel]

    def adds(self, run: int, channel: Channel, coefficients: Array) -> Array | float:
        """Return what the term adds to a channel of a run with coefficients (p,), standardised (N,); else 0.

        A run may have fewer columns than others: the coefficients of those that it lacks are of no matter there.
        """
        x, fixed = self.columns[run].get(channel), self.fixed[run].get(channel, 0.0)
        return fixed if x is None else fixed + x @ coefficients[: x.shape[1]]

    def wide(self, run: int, channel: Channel, samples: int) -> Array:
        """Return the columns of a run with zeros for those that it lacks, (samples, width)."""
        out = np.zeros((samples, self.width))
        x = self.columns[run].get(channel)
        if x is not None:
            out[:, : x.shape[1]] = x
        return out

    def with_runs(self, more: Term) -> Term:
        """Return the term on its runs and on those of another evaluation."""
        width = max(self.width, more.width)
        return replace(self, columns=self.columns + more.columns, fixed=self.fixed + more.fixed, width=width)


def make_term(data: Standardised, effect: Effect, site: str, shape: Shape) -> Term:
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


def again(data: Standardised, terms: Sequence[Term]) -> tuple[Term, ...]:
    """Return terms evaluated on other data of the same machine, each with its limit."""
    return tuple(replace(make_term(data, t.effect, t.site, t.shape), limit=t.limit) for t in terms)
