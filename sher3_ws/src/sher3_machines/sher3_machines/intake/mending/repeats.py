"""Rows that a logger polled twice, and channels that are slower than the log: a repeated reading is no sample.

A value that stays although its axis moves is told by what follows it: the next reading jumps by many of the smallest
steps of its column. A coarse encoder that moves slowly repeats its counts too, and goes on by one of them. Rows of
nothing but zeros are of wheels at rest, whose speed sets off with a jump.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from sher3_diagnosis.channel import Array, Mask

LONGEST_HOLD = 16
"""Rows in a row that may repeat one: where one row in three is polled again, an hour at 1 kHz holds a stretch of 14
(3^14 rows are 80 minutes). A longer one is an axis at rest, or a drive that is off.
"""
USUAL_HOLD = 5.0
"""Rows that usually repeat one, as a median, beyond which an axis dwells: it is started and stopped."""
FEWEST = 5
"""Repeats below which nothing is said: they may be chance."""
POLLED = 0.01
"""Share of the rows from which repeated ones are those of a logger that polls."""
HELD = 0.4
"""Share of the readings of one channel from which it is held: a channel at half the rate of the log repeats half."""
JUMP = 4.0
"""Smallest steps of a column beyond which its next reading was not reached by one more count; half of the repeats must
be followed so."""


def repeats(
    x: Array, least: float, longest: float = LONGEST_HOLD, usual: float = USUAL_HOLD, zeros: bool = True
) -> Mask:
    """Return (n,) True where a row of readings (n, m) repeats the one before without being a sample of its own.

    Args:
        x: readings; a single channel has m = 1.
        least: share of the rows from which repeats say anything.
        longest: rows in a row that may repeat one.
        usual: the same as a median.
        zeros: whether readings of nothing but zeros may repeat one.
    """
    out = np.zeros(len(x), dtype=bool)
    change = np.diff(x, axis=0)
    first, last = stretches(x)
    short = (last - first <= longest) & (last + 1 < len(x))
    short &= zeros | (x[first] != 0.0).any(axis=1)
    for a, b in zip(first[short], last[short], strict=True):
        out[a + 1 : b + 1] = True
    if out.sum() < max(FEWEST, least * len(x)) or np.median((last - first)[short]) > usual:
        return np.zeros_like(out)
    jumps = np.abs(x[last[short] + 1] - x[first[short]]) > JUMP * smallest_steps(change)
    return out if jumps.any(axis=1).mean() > 0.5 else np.zeros_like(out)


def stretches(x: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the rows (k,) of readings (n, m) that are repeated, and the last ones (k,) that repeat them."""
    same = np.concatenate([[False], (np.diff(x, axis=0) == 0.0).all(axis=1)])
    edges = np.flatnonzero(np.diff(np.concatenate([same.astype(np.int8), [0]])))
    return edges[::2], edges[1::2]


def smallest_steps(change: Array) -> Array:
    """Return the smallest change of each column, (m,), of changes (n, m); infinite for one that never changes."""
    size = np.abs(change)
    return np.asarray(np.where(size > 0.0, size, np.inf).min(axis=0, initial=np.inf))


def fresh_rows(columns: Sequence[Array]) -> Mask:
    """Return (n,) False where a row repeats its predecessor in all columns (n,) or (n, ...)."""
    flat = [np.nan_to_num(np.asarray(x, dtype=float).reshape(len(x), -1)) for x in columns]
    return ~repeats(np.hstack(flat), POLLED, zeros=False)


def fresh_readings(x: Array, steps: bool = True) -> Mask:
    """Return (n,) False where a channel (n,) that is slower than its log repeats a reading.

    A reading that stays for longer than the channel is held was read again: its axis rests there or turns round.

    Args:
        x: readings.
        steps: whether what is read may go in steps. An encoder may be held for any number of rows, if most of its
            readings are held for as many: nothing moves in steps.
    """
    x = np.nan_to_num(x)[:, None]
    fresh = ~repeats(x, HELD) if steps else ~_held(x)
    hold, at = hold_of(fresh), np.flatnonzero(fresh)
    stays = np.diff(at)
    for first, rows in zip(at[:-1][stays >= 1.5 * hold], stays[stays >= 1.5 * hold], strict=True):
        again = np.arange(1, round(rows / hold)) * hold
        fresh[first + np.rint(again).astype(int)] = True
    return fresh


def _held(x: Array) -> Mask:
    """Return (n,) True where an encoder (n, 1) that is slower than its log repeats a reading."""
    first, last = stretches(x)
    usual = float(np.median(last - first)) if len(first) else 0.0
    found = repeats(x, HELD, np.inf, np.inf)
    return found if usual <= USUAL_HOLD or hold_of(~found) > usual else np.zeros_like(found)


def goes_smoothly(x: Array) -> bool:
    """Return whether readings (n,) go on as they went: they are samples of a path, and no steps that are meant."""
    step = np.diff(x)
    return len(step) > 1 and float(np.std(np.diff(step))) < float(np.std(step))


def hold_of(fresh: Mask) -> float:
    """Return for how many rows a channel is held, as a median, of what `fresh_readings` (n,) returns."""
    at: NDArray[np.int64] = np.flatnonzero(fresh)
    return float(np.median(np.diff(at))) if len(at) > 1 else 1.0


def filled(x: Array, fresh: Mask) -> Array:
    """Return readings (n, ...) with those that are not fresh interpolated: without stamps each row has its place."""
    place = np.arange(len(x))
    flat = x.reshape(len(x), -1)
    out = [np.interp(place, place[fresh], column[fresh]) for column in flat.T]
    return np.stack(out, axis=1).reshape(x.shape)
