"""Products of terms with each other and with the target, per run and channel, computed once for each pair.

A fit needs nothing else of the samples. A search tries hundreds of terms beside the same few, so that all but one of
the products of a fit are at hand.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.term import Term

Products = tuple[Array, Array, Array]
"""Normal matrices (runs, p, p), right sides (runs, p) and energies (runs,)."""


class Blocks:
    """Columns and fixed part of a term side by side on a channel, per run (N, width + 1); None where it does not show.

    They are put together at the first product that is not at hand, and kept as long as the term stays in the trail.
    """

    def __init__(self, term: Term, channel: Channel) -> None:
        self.term, self.channel = term, channel
        self.fixed = any([channel in run for run in term.fixed])

    @cached_property
    def of_runs(self) -> list[Array | None]:
        """Return the block (n, p) of every run; None where the channel has no samples."""
        return [self._of(r) if self.channel in n else None for r, n in enumerate(self.term.samples)]

    def _of(self, run: int) -> Array:
        x, f = self.term.columns[run].get(self.channel), self.term.fixed[run].get(self.channel)
        out = np.zeros((self.term.samples[run][self.channel], self.term.width + 1))
        if x is not None:
            out[:, : x.shape[1]] = x
        if f is not None:
            out[:, -1] = f
        return out


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
    while same < most and trail[same + 1].blocks.term is terms[same]:
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
    term, key = blocks.term, (id(data), blocks.channel)
    if key not in term.products:
        out = np.zeros((len(data.target), term.width + 1))
        for r, (target, block) in enumerate(zip(data.target, blocks.of_runs, strict=True)):
            if block is not None and blocks.channel in target:
                out[r] = block.T @ target[blocks.channel]
        term.products[key] = (data, out)
    return term.products[key][1]


def _pair(a: Blocks, b: Blocks) -> Array:
    """Products of two terms, (runs, width_a + 1, width_b + 1)."""
    kept, key = a.term.products, (id(b.term), a.channel)
    if key not in kept:
        out = np.zeros((len(a.of_runs), a.term.width + 1, b.term.width + 1))
        for r, (left, right) in enumerate(zip(a.of_runs, b.of_runs, strict=True)):
            if left is not None and right is not None:
                # Beside a copy of itself: of one array NumPy computes half of the products, which rounds otherwise.
                out[r] = left.T @ (right.copy() if right is left else right)
        kept[key] = (b.term, out)
    return kept[key][1]
