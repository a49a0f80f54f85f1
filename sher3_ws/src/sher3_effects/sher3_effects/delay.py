"""A signal that is recorded late: the shift, and the longest delay that is looked for."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline
from sher3_diagnosis.channel import Array

LONGEST_DELAY = 0.25
"""Largest delay, s, that is searched; two recordings further apart are taken for two different moments."""


def shifted(x: Array, clock: Array, delay: float) -> Array:
    """Return x (n,) delayed by `delay` [s], linear between samples at `clock` (n,) [s]; its ends are held."""
    return np.interp(clock - delay, clock, x)


def shifted_path(q: Array, clock: Array, delay: float) -> Array:
    """Return a position (n,) as it was `delay` ago, s; its ends stay as they are.

    Nothing moves in steps: a spline is off by the fourth derivative, a line between two samples of a slow log by the
    second, which is an acceleration and looks like a spring.
    """
    return np.asarray(CubicSpline(clock, q)(np.clip(clock - delay, clock[0], clock[-1])))
