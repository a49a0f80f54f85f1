"""Periods suggested by what is left: over position, and over time from the start of a run."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_diagnosis.channel import Array
from sher3_diagnosis.discover.columns import Columns
from sher3_diagnosis.discover.dictionary import DIRECTION, Group, periodic
from sher3_diagnosis.discover.feature import Factor, Feature

BINS = 2048
"""Bins of a quantity's range: a period down to a few of them is seen."""
LONGEST = 1.5
"""Longest period that is suggested, in ranges of the quantity: a longer one is a bend."""
FINEST = 8
"""Shortest period, bins."""


def suggestions(columns: Columns, runs: Sequence[int], component: int, left: Sequence[Array]) -> list[Group]:
    """Return the strongest period of every place and clock, alone and times what may be modulated.

    Args:
        columns: of the place.
        runs: that are looked at.
        component: of the residual.
        left: per run, what is left, standardised (N,).
    """
    out = []
    for name, q in columns.quantities[runs[0]].items():
        if q.kind not in ("place", "clock") or not q.own:
            continue
        x = [columns.at_samples(r, Feature((Factor("itself", name),))) for r in runs]
        low, high = min(v.min() for v in x), max(v.max() for v in x)
        if not high > low:
            continue
        for carriers in _carriers(columns, runs[0], name, q.kind, high - low):
            weight = [columns.at_samples(r, Feature(carriers)) for r in runs]
            period = _strongest(x, [w * y for w, y in zip(weight, left, strict=True)], low, high)
            if period:
                out.append(periodic(name, period, *carriers))
    return out


def _carriers(columns: Columns, run: int, name: str, kind: str, span: float) -> list[tuple[Factor, ...]]:
    if kind == "clock" or columns.width > 1:
        return [()]
    own = {n: q for n, q in columns.quantities[run].items() if q.own}
    names = [n for n, q in own.items() if q.kind in ("force", "speed") or n == "acceleration"]
    return [(), (Factor("sliding", name, (DIRECTION * span,)),), *((Factor("itself", n),) for n in names)]


def _strongest(x: Sequence[Array], y: Sequence[Array], low: float, high: float) -> float:
    """Return the period of x in which y has most power; 0 where there is none."""
    total = np.zeros(BINS)
    for a, b in zip(x, y, strict=True):
        place = np.minimum(((a - low) / (high - low) * BINS).astype(int), BINS - 1)
        total += np.bincount(place, b, minlength=BINS)
    pad = 4
    power = np.abs(np.fft.rfft(total - total.mean(), pad * BINS))
    first, last = int(np.ceil(pad / LONGEST)), pad * BINS // FINEST
    if not power[first:last].any():
        return 0.0
    line = first + int(np.argmax(power[first:last]))
    return float((high - low) * pad / line)
