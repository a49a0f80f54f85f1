"""Up to which frequency the second difference of a noisy encoder still is an acceleration.

A mass found by least squares on a noisy acceleration is too small: the noise is in the regressor (attenuation). The
noise of a position grows with the square of the frequency when it is differentiated twice, the motion of a machine does
not; a lower cut-off, the same for every signal, takes the noise out and leaves the equations true.
"""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.filter import low_pass
from sher3_diagnosis.localise.readings import noise_of
from sher3_diagnosis.thresholds import EATEN

from sher3_chain.thresholds import NOISE_SHARE, SLOWEST_CUT

STEP = 0.8
"""Factor from one cut-off that is tried to the next."""
ENDS = 2.0
"""Periods of the cut-off at each end of a record that the filter spoils."""


def cut_off(position: Array, period: float, most: float, free: bool = False) -> float:
    """Return the highest cut-off, Hz, at which noise is a small share of the acceleration; at most `most`.

    Of a body that nothing drives hardly anything but its weight accelerates it, which is known or fitted: what is
    judged is the rest, and noise is to be a small share of that.

    Args:
        position: as recorded, (n,).
        period: of its samples, s.
        most: cut-off without noise, Hz.
        free: whether nothing drives the axis.
    """
    noise = noise_of(position)
    white = noise * np.random.default_rng(0).normal(size=len(position))
    cut, highest = most, most  # at no cut-off is there an acceleration to be told: none is worth the samples it costs
    while cut > SLOWEST_CUT:
        found, false = (_acceleration(x, period, cut) for x in (position, white))
        if np.var(false) <= NOISE_SHARE * np.var(found):
            highest = cut if highest == most else highest
            if not free or np.var(false) <= EATEN**2 * np.var(_without_weight(found, position, period, cut)):
                return cut
        cut *= STEP
    return highest


def _without_weight(acceleration: Array, position: Array, period: float, cut: float) -> Array:
    """Return what a weight at an arm, a spring and a constant leave of a filtered acceleration."""
    q = position[1:-1]
    near = np.column_stack([low_pass(x, period, cut) for x in (np.sin(q), np.cos(q), q)])
    end = (len(near) - len(acceleration)) // 2
    x = np.column_stack([near[end : len(near) - end], np.ones(len(acceleration))])
    return np.asarray(acceleration - x @ np.linalg.lstsq(x, acceleration, rcond=None)[0])


def _acceleration(x: Array, period: float, cut: float) -> Array:
    """Filtered second difference without the ends, which the filter spoils."""
    found = low_pass(np.diff(x, 2), period, cut) / period**2
    end = min(len(found) // 4, int(ENDS / cut / period))
    return found[end : len(found) - end]
