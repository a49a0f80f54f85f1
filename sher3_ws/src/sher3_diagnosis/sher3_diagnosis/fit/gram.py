"""Products of terms with each other and with the target, per run and channel, computed once for each pair.

A fit needs nothing else of the samples. A search tries hundreds of terms beside the same few, so that all but one of
the products of a fit are at hand.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.fit.term import Term
from sher3_diagnosis.fit.whitened import Whitened

Products = tuple[Array, Array, Array]
"""Normal matrices (runs, p, p), right sides (runs, p) and energies (runs,)."""


def products(data: Whitened, terms: Sequence[Term], channel: Channel) -> Products:
    """Return the normal matrices, right sides and energies of a channel.

    The energy is that of the target less the fixed parts of all terms; runs without the channel have zeros. Those of
    the leading terms are kept from the fit before: a search tries many last terms beside the same others.
    """
    trail = data.trails.setdefault(channel, [(None, _without_terms(data, channel))])
    same = next((i for i, (a, (b, _)) in enumerate(zip(terms, trail[1:], strict=False)) if a is not b), len(trail) - 1)
    same = min(same, len(terms))
    del trail[same + 1 :]
    for i, term in enumerate(terms[same:], start=same):
        trail.append((term, _extended(data, trail[-1][1], terms[:i], term, channel)))
    normal, right, energy = trail[-1][1]
    return normal, right, np.maximum(energy, 0.0)


def _without_terms(data: Whitened, channel: Channel) -> Products:
    runs = len(data.target)
    energy = np.array([data.null_loss.get((r, channel), 0.0) for r in range(runs)])
    return np.zeros((runs, 0, 0)), np.zeros((runs, 0)), energy


def _extended(data: Whitened, found: Products, others: Sequence[Term], term: Term, channel: Channel) -> Products:
    """Return the products of terms and one more, from those of the others."""
    runs, q = found[1].shape
    p = q + term.width
    normal, right, energy = np.zeros((runs, p, p)), np.zeros((runs, p)), found[2]
    normal[:, :q, :q], right[:, :q] = found[0], found[1]
    if channel not in term.channels:
        return normal, right, energy
    own, alone = _with_target(data, term, channel), _pair(term, term, channel, runs)
    normal[:, q:, q:] = alone[:, :-1, :-1]
    right[:, q:] = own[:, :-1] - alone[:, :-1, -1]
    energy = energy - 2.0 * own[:, -1] + alone[:, -1, -1]
    starts = accumulate((t.width for t in others), initial=0)
    for other, start in ((t, s) for t, s in zip(others, starts, strict=False) if channel in t.channels):
        both, at = _pair(term, other, channel, runs), slice(start, start + other.width)
        normal[:, q:, at] = both[:, :-1, :-1]
        normal[:, at, q:] = both[:, :-1, :-1].transpose(0, 2, 1)
        right[:, q:] -= both[:, :-1, -1]
        right[:, at] -= both[:, -1, :-1]
        energy = energy + 2.0 * both[:, -1, -1]
    return normal, right, energy


def _block(term: Term, run: int, channel: Channel, samples: int) -> Array | None:
    """Columns and fixed part of a term side by side, (N, width + 1); None where it does not show."""
    x, f = term.columns[run].get(channel), term.fixed[run].get(channel)
    if x is None and f is None:
        return None
    return np.column_stack([term.wide(run, channel, samples), np.zeros(samples) if f is None else f])


def _with_target(data: Whitened, term: Term, channel: Channel) -> Array:
    """Products of a term with the target, (runs, width + 1)."""
    key = (id(data), channel)
    if key not in term.products:
        out = np.zeros((len(data.target), term.width + 1))
        for r, target in enumerate(data.target):
            block = _block(term, r, channel, len(target[channel])) if channel in target else None
            if block is not None:
                out[r] = block.T @ target[channel]
        term.products[key] = (data, out)
    return term.products[key][1]


def _pair(a: Term, b: Term, channel: Channel, runs: int) -> Array:
    """Products of two terms, (runs, width_a + 1, width_b + 1)."""
    key = (id(b), channel)
    if key not in a.products:
        out = np.zeros((runs, a.width + 1, b.width + 1))
        for r in range(runs):
            if channel not in a.samples[r] or channel not in b.samples[r]:
                continue
            n = a.samples[r][channel]
            left, right = _block(a, r, channel, n), _block(b, r, channel, n)
            if left is not None and right is not None:
                out[r] = left.T @ right
        a.products[key] = (b, out)
    return a.products[key][1]
