"""Products of terms with each other and with the target, per run and channel, computed once for each pair.

A fit needs nothing else of the samples. A search tries hundreds of terms beside the same few, so that all but one of
the products of a fit are at hand.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.fit.term import Term
from sher3_diagnosis.fit.whitened import Whitened


def products(data: Whitened, terms: Sequence[Term], channel: Channel) -> tuple[Array, Array, Array]:
    """Return normal matrices (runs, p, p), right sides (runs, p) and energies (runs,) of a channel.

    The energy is that of the target less the fixed parts of all terms; runs without the channel have zeros.
    """
    widths = [t.width for t in terms]
    starts = np.cumsum([0, *widths])
    runs, p = len(data.target), int(starts[-1])
    normal, right = np.zeros((runs, p, p)), np.zeros((runs, p))
    energy = np.array([data.null_loss.get((r, channel), 0.0) for r in range(runs)])
    fixed = []
    for i, a in enumerate(terms):
        cols = slice(starts[i], starts[i + 1])
        own = _with_target(data, a, channel)
        right[:, cols] += own[:, :-1]
        energy -= 2.0 * own[:, -1]
        for j, b in enumerate(terms[: i + 1]):
            both = _pair(a, b, channel, runs)
            others = slice(starts[j], starts[j + 1])
            normal[:, cols, others] = both[:, :-1, :-1]
            normal[:, others, cols] = np.swapaxes(both[:, :-1, :-1], 1, 2)
            energy += both[:, -1, -1] * (1.0 if i == j else 2.0)
            fixed.append((cols, both[:, :-1, -1]))
            if i != j:
                fixed.append((others, both[:, -1, :-1]))
    for cols, part in fixed:
        right[:, cols] -= part
    return normal, right, np.maximum(energy, 0.0)


def _block(term: Term, run: int, channel: Channel, samples: int) -> Array | None:
    """Columns and fixed part of a term side by side, (N, width + 1); None where it does not show."""
    x, f = term.columns[run].get(channel), term.fixed[run].get(channel)
    if x is None and f is None:
        return None
    out = np.zeros((samples, term.width + 1))
    if x is not None:
        out[:, : x.shape[1]] = x
    if f is not None:
        out[:, -1] = f
    return out


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
