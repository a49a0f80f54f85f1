"""A signal that is recorded late: the shift, and the longest delay that is looked for."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array

LONGEST_DELAY = 0.25
"""Largest delay, s, that is searched; two recordings further apart are taken for two different moments."""
EARLIEST, OF_PERIODS = 0.02, 3.0
"""By how much an effort may come before the motion because a filter delays the position, s or in periods."""


def earliest(period: float) -> float:
    """Return the longest lead, s, of an effort over a motion of a period, s: a longer lead is no delay of a filter."""
    return max(EARLIEST, OF_PERIODS * period)


def shifted(x: Array, clock: Array, delay: float) -> Array:
    """Return x (n,) delayed by `delay` [s], linear between samples at `clock` (n,) [s]; its ends are held."""
    return np.interp(clock - delay, clock, x)
