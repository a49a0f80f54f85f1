"""Single readings that are missing or impossible."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sher3_diagnosis.channel import Array, Mask

from sher3_machines.errors import MachineError

MISSING = 0.05
"""Share of the samples of a signal without stamps that may be missing."""
LONGEST_GAP = 10
"""Readings in a row that are interpolated over where no stamps say how long they take."""
GLITCH = 20.0
"""Distance of a reading from its neighbours' median, over the distance that 97 of 100 readings keep, from which it is a
glitch. Not 99 of 100: of a few hundred rows, three bad readings are one in a hundred."""
GLITCH_TRAVEL = 0.05
"""Share of the travel by which a glitch is off at least."""
FEW_GLITCHES = 0.005
"""Share of the samples that may be glitches: more are a signal."""
SOME_GLITCHES = 3
"""Glitches that a short record may have."""
NEIGHBOURS = 5
"""Readings over which that median is taken."""
FEWEST = 3
"""Readings below which nothing can be said of a signal."""


def known_readings(x: Array, stamped: bool, what: str) -> tuple[Mask, str]:
    """Return which readings of a signal (n,) are numbers, and a note; empty where all are.

    With stamps the others are left out: a log that merges topics has a reading of one in many lines. Without stamps
    they are interpolated, so that a few in a row are the most.

    Raises:
        MachineError: too many are missing.
    """
    known: Mask = np.isfinite(x)
    bad = int((~known).sum())
    if bad == 0:
        return known, ""
    longest = longest_run(~known)
    if int(known.sum()) < FEWEST or (not stamped and (longest > LONGEST_GAP or bad > MISSING * len(x))):
        raise MachineError(
            f"{what} is not finite at sample {int(np.argmin(known))}",
            value=f"{bad} of {len(x)} samples, {longest} in a row",
            limit=f"{LONGEST_GAP} in a row, {MISSING:.0%} in all",
            remedy="cut the record before or after, or give a time column",
        )
    return known, f"{what}: {bad} of {len(x)} readings are missing or not finite; interpolated"


def stays(x: Array) -> Array:
    """Return a signal (n,) in which each reading stays until the next one; before the first one it is nan."""
    last = np.maximum.accumulate(np.where(np.isfinite(x), np.arange(len(x)), -1))
    return np.where(last >= 0, x[last], np.nan)


def glitches(x: Array) -> NDArray[np.int64]:
    """Return the samples of a position (n,) that are far off their neighbours on both sides; empty for a signal."""
    if len(x) < 4 * NEIGHBOURS:
        return np.zeros(0, dtype=np.int64)
    windows = np.lib.stride_tricks.sliding_window_view(x, NEIGHBOURS)
    off = np.zeros(len(x))
    half = NEIGHBOURS // 2
    off[half : len(x) - half] = np.abs(x[half : len(x) - half] - np.median(windows, axis=1))
    low, high = np.quantile(x, [0.01, 0.99])
    limit = max(GLITCH * float(np.quantile(off, 0.97)), GLITCH_TRAVEL * float(high - low))
    found = np.flatnonzero(off > limit) if limit > 0.0 else np.zeros(0, dtype=np.int64)
    return found if len(found) <= max(SOME_GLITCHES, FEW_GLITCHES * len(x)) else found[:0]


def longest_run(mask: Mask) -> int:
    """Return the largest number of samples in a row for which a mask (n,) holds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return int((edges[1::2] - edges[::2]).max()) if len(edges) else 0
