"""The grid of the residuals: a zero-phase low-pass, then samples that are close to independent.

Counting such samples counts information, which is what losses and their prices are stated in.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.signal import butter, sosfiltfilt

from sher3_diagnosis.channel import Array, Mask

BANDWIDTH = 40.0
"""Cut-off of the zero-phase low-pass on residuals and regressors, Hz."""
DECIMATED_RATE = 100.0
"""Rate of the residual grid, Hz: that of the external tracker."""
EDGE = 0.05
"""Seconds at each end of a run that the filter spoils."""
SHORT = 30
"""Samples below which a signal is too short for the filter and is left as it is."""
NEAR_NYQUIST = 0.4
"""Product of cut-off and period from which the low-pass would change nothing that is left to see."""


def low_pass(x: Array, period: float, cutoff: float = BANDWIDTH) -> Array:
    """Return x (n, ...) after a zero-phase second-order Butterworth low-pass along the first axis.

    Args:
        x: signal.
        period: of its samples, s.
        cutoff: Hz; a cut-off above `NEAR_NYQUIST` / period leaves `x` as it is.
    """
    if cutoff * period >= NEAR_NYQUIST or len(x) < SHORT:
        return np.asarray(x, dtype=float)
    return sosfiltfilt(_butterworth(period, cutoff), x, axis=0)


@lru_cache(maxsize=32)
def _butterworth(period: float, cutoff: float) -> Array:
    return butter(2, cutoff, fs=1.0 / period, output="sos")


def settled(known: Mask, margin: int = 3) -> Mask:
    """Shrink a mask (g,) by `margin` samples at each of its borders: the low-pass spreads what happens outside it."""
    out = known.copy()
    for shift in range(1, margin + 1):
        out[shift:] &= known[:-shift]
        out[:-shift] &= known[shift:]
    return out
