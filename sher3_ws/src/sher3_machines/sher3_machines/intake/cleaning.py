"""Small faults of a log, mended and said: stamps that repeat, single readings that are missing or impossible."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sher3_diagnosis.channel import Array, Mask

from sher3_machines.errors import MachineError

ROUNDED = 0.2
"""Share of steps of zero from which stamps are rounded; fewer are samples that were written twice."""
MISSING = 0.05
"""Share of the samples of a signal with stamps that may be missing without a word."""
LONGEST_GAP = 10
"""Readings in a row that are interpolated over where no stamps say how long they take."""
GLITCH = 20.0
"""A reading off its neighbours' median by so many times what 99 of 100 readings are off is none of the machine's."""
GLITCH_TRAVEL = 0.05
"""Share of the travel by which a glitch is off at least."""
FEW_GLITCHES = 0.005
"""Share of the samples that may be glitches: more are a signal."""
NEIGHBOURS = 5
"""Readings over which that median is taken."""
FEWEST = 3
"""Stamps below which nothing can be said of them."""
MIXED_UP = 10.0
"""Periods by which a sample may come too late in a log; what comes later belongs to another record."""


def even_stamps(stamps: Array, run: str) -> tuple[Array, NDArray[np.int64], str]:
    """Return stamps (m,) that increase, the (m,) samples they are of, and a note; empty where none is needed.

    Samples that come in a wrong order are sorted, those that were written twice left out, and rounded stamps put on the
    line through them. Stamps that run far backwards stay as they are.

    Raises:
        MachineError: nobody knows when the samples were taken: time stands still, or rounded stamps are no line.
    """
    if stamps.ndim != 1:
        raise MachineError(f"{run}: the time is no column of numbers", value=stamps.shape, remedy="correct `time`")
    kept = np.flatnonzero(np.isfinite(stamps))
    notes = [f"{len(stamps) - len(kept)} samples without a stamp are left out"] if len(kept) < len(stamps) else []
    steps = np.diff(stamps[kept])
    if len(steps) < FEWEST or not (steps > 0.0).any():
        raise MachineError(
            f"{run}: time does not increase",
            value=f"{len(kept)} stamps",
            limit=f"{FEWEST} different ones",
            remedy="give the column of the stamps, or state the rate of the samples: `time: {rate: HZ}`",
        )
    usual = float(np.median(steps[steps > 0.0]))
    if (steps < 0.0).any() and steps.min() > -MIXED_UP * usual:
        kept = kept[np.argsort(stamps[kept], kind="stable")]
        notes.append(f"{int((steps < 0.0).sum())} samples came in a wrong order; sorted by their stamps")
        steps = np.diff(stamps[kept])
    found, told = stamps[kept], float(np.mean(steps == 0.0))
    if 0.0 < told < ROUNDED:
        first = np.concatenate([[True], steps != 0.0])
        found, kept = found[first], kept[first]
        notes.append(f"{int((~first).sum())} stamps are there twice; the first one is taken")
    elif told >= ROUNDED and (steps >= 0.0).all():
        found = _on_a_line(found, told, float(steps[steps > 0.0].min()), run)
        notes.append(f"stamps are rounded to {steps[steps > 0.0].min():.3g} s; samples are taken as even")
    return found, kept, f"{run}: {', '.join(notes)}" if notes else ""


def _on_a_line(stamps: Array, repeated: float, rounding: float, run: str) -> Array:
    """Return rounded stamps on the line through the first and the last one; raises MachineError where they are none."""
    line = np.linspace(stamps[0], stamps[-1], len(stamps))
    off = float(np.abs(line - stamps).max())
    if off > 2.0 * rounding:
        raise MachineError(
            f"{run}: {repeated:.0%} of the stamps repeat the one before",
            value=f"{off:.3g} s off an even clock",
            limit=f"{2.0 * rounding:.3g} s",
            remedy="record finer stamps, or state the rate of the samples: `time: {rate: HZ}`",
        )
    return line


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


def glitches(x: Array) -> NDArray[np.int64]:
    """Return the samples of a position (n,) that are far off their neighbours on both sides; empty for a signal."""
    if len(x) < 4 * NEIGHBOURS:
        return np.zeros(0, dtype=np.int64)
    windows = np.lib.stride_tricks.sliding_window_view(x, NEIGHBOURS)
    off = np.zeros(len(x))
    half = NEIGHBOURS // 2
    off[half : len(x) - half] = np.abs(x[half : len(x) - half] - np.median(windows, axis=1))
    low, high = np.quantile(x, [0.01, 0.99])
    limit = max(GLITCH * float(np.quantile(off, 0.99)), GLITCH_TRAVEL * float(high - low))
    found = np.flatnonzero(off > limit) if limit > 0.0 else np.zeros(0, dtype=np.int64)
    return found if len(found) <= max(1.0, FEW_GLITCHES * len(x)) else found[:0]


def longest_run(mask: Mask) -> int:
    """Return the largest number of samples in a row for which a mask (n,) holds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return int((edges[1::2] - edges[::2]).max()) if len(edges) else 0
