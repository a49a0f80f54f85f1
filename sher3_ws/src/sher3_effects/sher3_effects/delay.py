"""A signal that is recorded late: the shift, and the longest delay that is looked for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array

LONGEST_DELAY = 0.25
"""Largest delay, s, that is searched; two recordings further apart are taken for two different moments."""
FURTHER = 1.5
"""Factor from one time that is tried to the next, where periods are far shorter."""
EARLIEST, OF_PERIODS = 0.02, 3.0
"""By how much an effort may come before the motion because a filter delays the position, s or in periods."""


def earliest(period: float) -> float:
    """Return the longest lead, s, of an effort over a motion of a period, s: a longer lead is no delay of a filter."""
    return max(EARLIEST, OF_PERIODS * period)


def tried(periods: Sequence[float], period: float) -> list[float]:
    """Return times, s: of so many periods each, and on to `LONGEST_DELAY`, each half as much again.

    A servo is late by a time of its own, however fast it is logged.
    """
    times = [n * period for n in periods]
    while times[-1] * FURTHER <= LONGEST_DELAY:
        times.append(times[-1] * FURTHER)
    return times


def shifted(x: Array, clock: Array, delay: float) -> Array:
    """Return x (n,) delayed by `delay` [s], linear between samples at `clock` (n,) [s]; its ends are held."""
    return np.interp(clock - delay, clock, x)
