"""Small summaries of samples, and the matching of streams by stamp."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Spread:
    """Median, 99th percentile and maximum of a quantity, in its unit."""

    p50: float
    p99: float
    max: float

    @classmethod
    def of(cls, values: NDArray[Any]) -> Spread | None:
        """Return the spread of finite values, None when there are none."""
        finite = values[np.isfinite(values)]
        if not len(finite):
            return None
        p50, p99 = np.percentile(finite, [50, 99])
        return cls(float(p50), float(p99), float(finite.max()))


def common(a: NDArray[np.int64], b: NDArray[np.int64]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the rows (indices) of a and of b that carry equal stamps, in the order of the stamps."""
    _, rows_a, rows_b = np.intersect1d(a, b, return_indices=True)
    return rows_a, rows_b


def smooth(values: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """Return the moving average of (n, k) values over `width` rows, without lag.

    Near the ends, where fewer rows exist, the average is over those that exist.
    """
    kernel = np.ones(width)
    weight = np.convolve(np.ones(len(values)), kernel, "same")
    return np.stack([np.convolve(column, kernel, "same") / weight for column in values.T], axis=1)


def width_of(stamp: NDArray[np.int64], seconds: float) -> int:
    """Return how many samples make up `seconds` at the median rate of these stamps [ns]; at least one."""
    period = float(np.median(np.diff(stamp))) if len(stamp) > 1 else 0.0
    return max(1, round(seconds * 1e9 / period)) if period > 0 else 1
