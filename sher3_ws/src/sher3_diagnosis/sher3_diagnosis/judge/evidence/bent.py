"""What a bent law leaves: in proportion to what it does, and nothing where it does nothing.

No machine follows a page exactly. A right law of which the size differs by a few per cent from place to place leaves a
remainder of variance tau^2 s^2 where it adds s. A law that stands in for another leaves something also where it adds
nothing: a variance that does not know s. Both parts are told apart by most likelihood of

    remainder ~ N(0, 1 + a + b s^2)

for each component, in squares of the floor, without any view of how either part varies.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.fit.fitting import Fit

ROUNDS = 60
"""Steps of the multiplicative updates: the share then moves by less than a tenth of the remainder."""
NOTHING = 1e-12
"""Square of the floor below which a law adds nothing to a component."""


def stray_share(left: Array, own: Array) -> float:
    """Return the share, 0 to 1, of a remainder's power over the floor that is not in proportion to what a law adds.

    Multiplicative updates for the Itakura-Saito divergence (Fevotte and Idier, 2011), which each raise the likelihood.
    All of it, where a part in proportion does not make the remainder likelier than its one more number does by chance
    (the Bayesian information criterion).

    Args:
        left: (n, d) remainder over its floor.
        own: (n, d) what the law adds, in any unit that is one for each component.
    """
    x, u = left**2, own**2
    size = u.mean(axis=0)
    u = u / np.maximum(size, NOTHING)
    excess = np.maximum(x.mean(axis=0) - 1.0, 1e-3)
    acts = size > NOTHING
    stray, bend = np.where(acts, 0.5, 1.0) * excess, np.where(acts, 0.5, 0.0) * excess
    for _ in range(ROUNDS):
        stray = stray * _step(x, np.ones_like(u), 1.0 + stray + bend * u)
        bend = bend * _step(x, u, 1.0 + stray + bend * u)
    gain = _surprise(x, np.broadcast_to(1.0 + excess, x.shape)) - _surprise(x, 1.0 + stray + bend * u)
    distinct = gain > 0.5 * math.log(len(x))
    whole = float((stray + bend).sum())
    return float(np.where(distinct, stray, stray + bend).sum() / whole) if whole > 0.0 else 1.0


def _surprise(x: Array, variance: Array) -> Array:
    """Return (d,) minus the log likelihood of samples with squares x (n, d), up to a constant."""
    return np.asarray(0.5 * (np.log(variance) + x / variance).sum(axis=0))


def _step(x: Array, part: Array, variance: Array) -> Array:
    """Return the factor on the sizes (d,) of one part of a variance (n, d) of samples with squares x."""
    asked, given = (part * x / variance**2).sum(axis=0), (part / variance).sum(axis=0)
    return np.sqrt(asked / np.maximum(given, NOTHING))


def added(fit: Fit, index: int, channel: Channel, runs: Mapping[int, Array]) -> Array:
    """Return (n, d) what one term of a fit adds to a channel over its floor, on runs {run: (N, d)}, one after another.

    With the coefficients of the other runs, as what is left.
    """
    term, out = fit.terms[index], []
    for r, like in runs.items():
        adds = term.adds(r, channel, fit.loro_of(index)[r])
        out.append(np.broadcast_to(adds, like.size).reshape(like.shape))
    return np.concatenate(out)
