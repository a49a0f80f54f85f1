"""A clock whose stamps jitter though its samples are even: recorded speeds say how many periods lie between two rows.

A logger stamps a sample when it comes to it, often by half a period and more too late or too early, and loses some. A
place that was differentiated twice turns that into accelerations far beyond those of the motion. What a joint moved
from row to row over its speed is the time that passed for it: where that is a whole number of periods at nearly every
row, it is the clock. A logger that writes the number of the row times a period loses some without a sign in its stamps:
what has passed is then longer than they say.
"""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.intake.mending.repeats import HELD

MOVING = 0.05
"""Mean square of the speed, over its mean, from which it tells the time between two rows."""
FEWEST = 100
"""Rows in motion below which nothing is said."""
NEAR = 0.25
"""Periods by which what passed may be off a whole number."""
MOST = 0.9
"""Share of the rows in motion that must be near one."""
CLEARER = 0.5
"""Residual of the time that passed about whole periods, over its residual about the stamps, below which the whole
periods are the clock."""
SURE = 0.15
"""Standard deviation of the time that passed, in periods, up to which a slow row counts too: three of them are less
than half a period."""
EVEN = 1e-3
"""Share of a period by which the steps of stamps that were counted, and not taken, may differ: their rounding."""
LONGEST = 20.0
"""Periods between two rows beyond which the stamps are believed: a mean of two speeds tells no such time."""


def counted_stamps(t: Array, x: Array, v: Array) -> Array | None:
    """Return stamps (n,) by the periods that the motion tells; None where it tells none, or the stamps are as good.

    Rows between which no time passed have one stamp; those between which nothing moved are a period apart. Of a log
    that is faster than the places and speeds in it new readings are counted; they rest for as long as they are held.

    Args:
        t: stamps (n,), s, that grow.
        x: places (n, k), m or rad.
        v: their speeds (n, k).
    """
    new = np.concatenate([[True], np.any(np.diff(np.column_stack([x, v]), axis=0) != 0.0, axis=1)])
    held = bool(new.mean() < 1.0 - HELD)
    if held:
        counted = _counted(t[new], x[new], v[new], held)
        return None if counted is None else counted[np.cumsum(new) - 1]
    return _counted(t, x, v, held)


def _counted(t: Array, x: Array, v: Array, held: bool) -> Array | None:
    """Return stamps (n,) as `counted_stamps` does; of readings that were `held` the log says for how many periods."""
    if len(t) <= FEWEST or not (np.diff(t) > 0.0).all():
        return None
    mean = 0.5 * (v[1:] + v[:-1])
    usual = np.mean(mean**2, axis=0)
    if not usual.all() or _speed_mismatch(t, x, v) < CLEARER * _speed_mismatch(t, x, np.concatenate([v[:1], mean])):
        return None
    square = np.sum(mean**2 / usual, axis=1)
    passed = np.sum(np.diff(x, axis=0) * mean / usual, axis=1) / np.maximum(square, np.finfo(float).tiny)
    hole = np.diff(t) > LONGEST * np.median(np.diff(t))
    moving = (square > MOVING * square.mean()) & ~hole
    period = float(np.median(passed[moving])) if moving.sum() >= FEWEST else 0.0
    if not period > 0.0:
        return None
    counts = np.maximum(np.round(passed / period), 0.0)
    off, by_stamps = np.abs(passed - period * counts), np.abs(passed - np.diff(t))
    if np.mean(off[moving] < NEAR * period) < MOST or rms(off[moving]) > CLEARER * rms(by_stamps[moving]):
        return None
    noise = rms((off * np.sqrt(square))[moving])
    rest = np.maximum(np.round(np.diff(t) / period), 1.0) if held else 1.0
    counts = np.where(noise < SURE * period * np.sqrt(square), counts, rest)
    steps = np.diff(t)  # taken as they came, the whole takes as long as they say; counted, each says the period
    period = float(steps[0] if is_even(t) else steps[~hole].sum() / counts[~hole].sum())
    return np.asarray(t[0] + np.concatenate([[0.0], np.cumsum(np.where(hole, steps, period * counts))]))


def _speed_mismatch(t: Array, x: Array, v: Array) -> float:
    """Return how far places (n, k) are off what their speeds make of the stamps before, over the speeds: s.

    Speeds that were made of the places, as differences over these stamps, say nothing of another clock.
    """
    off = np.diff(x, axis=0) - v[1:] * np.diff(t)[:, None]
    return rms(off / np.sqrt(np.mean(v**2, axis=0)))


def is_even(t: Array) -> bool:
    """Return whether stamps (n,) are the number of the row times a period."""
    steps = np.diff(t)
    return bool(np.ptp(steps) < EVEN * steps.mean())


def rms(x: Array) -> float:
    """Return the root mean square of all numbers of an array of any shape."""
    return float(np.sqrt(np.mean(x**2)))
