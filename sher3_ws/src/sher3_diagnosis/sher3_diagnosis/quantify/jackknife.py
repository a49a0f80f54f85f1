"""Standard error of a value by the jackknife: its values without each part of the data in turn (Tukey 1958)."""

from __future__ import annotations

import numpy as np

from sher3_diagnosis.channel import Array


def standard_error(draws: Array) -> Array:
    """Return the standard error (...) of values computed without each of n parts, (n, ...)."""
    n = len(draws)
    return np.asarray(np.sqrt((n - 1) / n * np.sum((draws - draws.mean(axis=0)) ** 2, axis=0)))
