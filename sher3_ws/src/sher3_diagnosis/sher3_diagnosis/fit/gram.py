"""Products of terms with each other and with the target, per run and channel, computed once for each pair.

A fit needs nothing else of the samples. A search tries hundreds of terms beside the same few, so that all but one of
the products of a fit are at hand.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import accumulate
from typing import NamedTuple

import numpy as np
from sher3_common.compiled import compiled

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.term import Term

Products = tuple[Array, Array, Array]
"""Normal matrices (runs, p, p), right sides (runs, p) and energies (runs,)."""


class Rows:
    """Columns of a channel as rows of one array (p, N), the samples of all runs behind each other.

    Attributes:
        values: (p, N).
        ends: where each run ends, (runs + 1,) from 0; a run without samples has none.
    """

    def __init__(self, of_runs: Sequence[Sequence[tuple[int, Array]]], samples: Sequence[int], width: int) -> None:
        """Take the columns (n,) or (n, p) of every run, each with the row that it begins at, and samples per run."""
        self.ends = np.array([0, *accumulate(samples)])
        self.values = np.zeros((width, int(self.ends[-1])))
        for placed, begin, end in zip(of_runs, self.ends[:-1], self.ends[1:], strict=True):
            for row, x in placed:
                self.values[row : row + (x.shape[1] if x.ndim == 2 else 1), begin:end] = x.T

    def with_rows(self, other: Rows) -> Array:
        """Return the products of every run with other rows, (runs, p, q): zero where either has no samples."""
        found: Array = _products(self.values, self.ends, other.values, other.ends)
        return found


@compiled(fastmath={"reassoc", "contract"}, nogil=True)
def _products(a: Array, ends_of_a: Array, b: Array, ends_of_b: Array) -> Array:
    """Sums in any order: four at a time, and without the call of a library for each run."""
    out = np.zeros((len(ends_of_a) - 1, len(a), len(b)))
    for r in range(len(out)):
        n, i0, j0 = ends_of_a[r + 1] - ends_of_a[r], ends_of_a[r], ends_of_b[r]
        if ends_of_b[r + 1] - j0 != n:
            continue
        for i in range(len(a)):
            for j in range(len(b)):
                x, y, sum_ = a[i, i0 : i0 + n], b[j, j0 : j0 + n], 0.0
                for k in range(n):
                    sum_ += x[k] * y[k]
                out[r, i, j] = sum_
    return out


class Blocks:
    """Columns and fixed part of a term side by side on a channel, (width + 1, N).

    They are put together at the first product that is not at hand, and kept as long as the term stays in the trail.
    """

    def __init__(self, term: Term, channel: Channel) -> None:
        self.term, self.channel = term, channel
        self.fixed = any([channel in run for run in term.fixed])

    @cached_property
    def rows(self) -> Rows:
        """Return the rows of all runs; runs that lack columns which others have get zeros."""
        term, c, parts = self.term, self.channel, []
        for x, f in zip(term.columns, term.fixed, strict=True):
            parts.append([(row, values[c]) for row, values in ((0, x), (term.width, f)) if c in values])
        return Rows(parts, [run.get(c, 0) for run in term.samples], term.width + 1)


class Step(NamedTuple):
    """The last term of a trail, its blocks and the products of all terms so far."""

    blocks: Blocks | None
    found: Products


def products(data: Standardised, terms: Sequence[Term], channel: Channel) -> Products:
    """Return the normal matrices, right sides and energies of a channel.

    The energy is that of the target less the fixed parts of all terms; runs without the channel have zeros. Those of
    the leading terms are kept from the fit before: a search tries many last terms beside the same others.
    """
    if (trail := data.trails.get(channel)) is None:
        trail = data.trails[channel] = [Step(None, _without_terms(data, channel))]
    same, most = 0, min(len(terms), len(trail) - 1)
    while same < most and (kept := trail[same + 1].blocks) is not None and kept.term is terms[same]:
        same += 1
    del trail[same + 1 :]
    for term in terms[same:]:
        blocks = Blocks(term, channel)
        trail.append(Step(blocks, _extended(data, trail, blocks)))
    normal, right, energy = trail[-1].found
    return normal, right, np.maximum(energy, 0.0)


def _without_terms(data: Standardised, channel: Channel) -> Products:
    runs = len(data.target)
    energy = np.array([data.null_loss.get((r, channel), 0.0) for r in range(runs)])
    return np.zeros((runs, 0, 0)), np.zeros((runs, 0)), energy


def _extended(data: Standardised, trail: Sequence[Step], new: Blocks) -> Products:
    """Return the products of the terms of a trail and one more."""
    before, term, channel = trail[-1].found, new.term, new.channel
    runs, q = before[1].shape
    p = q + term.width
    normal, right, energy = np.zeros((runs, p, p)), np.zeros((runs, p)), before[2]
    normal[:, :q, :q], right[:, :q] = before[0], before[1]
    if channel not in term.channels:
        return normal, right, energy
    own, alone = _with_target(data, new), _pair(new, new)
    normal[:, q:, q:] = alone[:, :-1, :-1]
    right[:, q:] = own[:, :-1] - alone[:, :-1, -1]
    energy = energy - 2.0 * own[:, -1] + alone[:, -1, -1]
    start = 0
    for other in [blocks for blocks, _ in trail if blocks is not None]:
        at = slice(start, start := start + other.term.width)
        if channel not in other.term.channels:
            continue
        both = _pair(new, other)
        normal[:, q:, at] = both[:, :-1, :-1]
        normal[:, at, q:] = both[:, :-1, :-1].transpose(0, 2, 1)
        if other.fixed:
            right[:, q:] -= both[:, :-1, -1]
        if new.fixed:
            right[:, at] -= both[:, -1, :-1]
            energy = energy + 2.0 * both[:, -1, -1]
    return normal, right, energy


def _with_target(data: Standardised, blocks: Blocks) -> Array:
    """Products of a term with the target, (runs, width + 1)."""
    kept, key = blocks.term.products, (id(data), blocks.channel)
    if key not in kept:
        kept[key] = (data, blocks.rows.with_rows(_target(data, blocks.channel))[..., 0])
    return kept[key][1]


def _target(data: Standardised, channel: Channel) -> Rows:
    if channel not in data.rows:
        parts = [[(0, run[channel])] if channel in run else [] for run in data.target]
        data.rows[channel] = Rows(parts, [len(run.get(channel, ())) for run in data.target], 1)
    return data.rows[channel]


def _pair(a: Blocks, b: Blocks) -> Array:
    """Products of two terms, (runs, width_a + 1, width_b + 1)."""
    kept, key = a.term.products, (id(b.term), a.channel)
    if key not in kept:
        kept[key] = (b.term, a.rows.with_rows(b.rows))
    return kept[key][1]
