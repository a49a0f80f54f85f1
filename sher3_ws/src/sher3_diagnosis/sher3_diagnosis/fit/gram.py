"""Products of terms with each other and with the target, per run and channel, computed once for each pair.

A fit needs nothing else of the samples. A search tries hundreds of terms beside the same few, so that all but one of
the products of a fit are at hand.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from sher3_common.compiled import compiled_ieee

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.fit.rows import Rows
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.term import Term

Products = tuple[Array, Array, Array]
"""Normal matrices (runs, p, p), right sides (runs, p) and energies (runs,)."""


class Step(NamedTuple):
    """The last term of a trail and the products of all terms so far."""

    term: Term | None
    found: Products


def products(data: Standardised, terms: Sequence[Term], channel: Channel) -> Products:
    """Return the normal matrices, right sides and energies of a channel.

    The energy is that of the target less the fixed parts of all terms; runs without the channel have zeros. Those of
    the leading terms are kept from the fit before: a search tries many last terms beside the same others.
    """
    if (trail := data.trails.get(channel)) is None:
        trail = data.trails[channel] = [Step(None, _without_terms(data, channel))]
    same, most = 0, min(len(terms), len(trail) - 1)
    while same < most and trail[same + 1].term is terms[same]:
        same += 1
    del trail[same + 1 :]
    for i in range(same, len(terms)):
        both = np.concatenate([_pair(terms[i], other, channel) for other in terms[: i + 1]], axis=2)
        widths = np.array([other.width for other in terms[: i + 1]])
        normal, right, energy = trail[-1].found
        own = _with_target(data, terms[i], channel)
        trail.append(Step(terms[i], _extended(normal, right, energy, own, both, widths)))
    normal, right, energy = trail[-1].found
    return normal, right, np.maximum(energy, 0.0)


def _without_terms(data: Standardised, channel: Channel) -> Products:
    runs = len(data.target)
    energy = np.array([data.null_loss.get((r, channel), 0.0) for r in range(runs)])
    return np.zeros((runs, 0, 0)), np.zeros((runs, 0)), energy


@compiled_ieee
def _extended(normal: Array, right: Array, energy: Array, own: Array, both: Array, widths: Array) -> Products:
    """Return the products of some terms and one more, whose fixed part comes last: (target - fixed) of all is fitted.

    Args:
        normal: of the terms before, (runs, q, q).
        right: of the terms before, (runs, q).
        energy: (runs,).
        own: products of the new term's columns and fixed part with the target, (runs, width + 1).
        both: with columns and fixed part of each term before and of itself, (runs, width + 1, ...).
        widths: of all terms, the new one last.
    """
    runs, q = right.shape
    w = own.shape[1] - 1
    more, against, left = np.zeros((runs, q + w, q + w)), np.zeros((runs, q + w)), energy - 2.0 * own[:, w]
    for r in range(runs):
        more[r, :q, :q], against[r, :q], against[r, q:] = normal[r], right[r], own[r, :w]
        at, row = 0, 0
        for k, width in enumerate(widths):
            share = 1.0 if k < len(widths) - 1 else 0.5  # with itself each product is met twice
            for i in range(w):
                for j in range(width):
                    more[r, q + i, at + j] = more[r, at + j, q + i] = both[r, i, row + j]
                against[r, q + i] -= share * both[r, i, row + width]
            for j in range(width):
                against[r, at + j] -= share * both[r, w, row + j]
            left[r] += 2.0 * share * both[r, w, row + width]
            at, row = at + width, row + width + 1
    return more, against, left


def _with_target(data: Standardised, term: Term, channel: Channel) -> Array:
    """Products of a term with the target, (runs, width + 1)."""
    key = id(data), channel
    if key not in term.products:
        term.products[key] = (data, term.rows(channel).with_rows(_target(data, channel))[..., 0])
    return term.products[key][1]


def _target(data: Standardised, channel: Channel) -> Rows:
    if channel not in data.rows:
        parts = [[(0, run[channel])] if channel in run else [] for run in data.target]
        data.rows[channel] = Rows(parts, [len(run.get(channel, ())) for run in data.target], 1)
    return data.rows[channel]


def _pair(a: Term, b: Term, channel: Channel) -> Array:
    """Products of two terms, (runs, width_a + 1, width_b + 1): zero where one of them does not show."""
    key = id(b), channel
    if key not in a.products:
        a.products[key] = (b, a.rows(channel).with_rows(b.rows(channel)))
    return a.products[key][1]
