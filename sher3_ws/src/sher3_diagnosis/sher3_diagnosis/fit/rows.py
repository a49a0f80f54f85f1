"""Columns of all runs as rows of one array, and their products per run in compiled code."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

import numpy as np
from sher3_common.compiled import compiled

from sher3_diagnosis.channel import Array


class Rows:
    """Columns of a channel as rows of one array, the samples of all runs behind each other.

    Attributes:
        values: (p, N).
        ends: where each run ends, (runs + 1,) from 0; a run without samples has none.
    """

    def __init__(self, of_runs: Sequence[Sequence[tuple[int, Array]]], samples: Sequence[int], width: int) -> None:
        """Take the columns (n,) or (n, p) of every run, each with the row that it begins at, and samples per run."""
        self.ends = np.array([0, *accumulate(samples)])
        self.values = np.zeros((width, int(self.ends[-1])))
        for placed, begin, end in zip(of_runs, self.ends[:-1], self.ends[1:], strict=True):
            for row, x in placed:
                self.values[row : row + (x.shape[1] if x.ndim == 2 else 1), begin:end] = x.T

    def with_rows(self, other: Rows) -> Array:
        """Return the products of every run with other rows, (runs, p, q): zero where either has no samples."""
        found: Array = _products(self.values, self.ends, other.values, other.ends)
        return found


@compiled(fastmath={"reassoc", "contract"}, nogil=True)
def _products(a: Array, ends_of_a: Array, b: Array, ends_of_b: Array) -> Array:
    """Sums in any order: four at a time, and without the call of a library for each run."""
    out = np.zeros((len(ends_of_a) - 1, len(a), len(b)))
    for r in range(len(out)):
        n, i0, j0 = ends_of_a[r + 1] - ends_of_a[r], ends_of_a[r], ends_of_b[r]
        if ends_of_b[r + 1] - j0 != n:
            continue
        for i in range(len(a)):
            for j in range(len(b)):
                x, y, sum_ = a[i, i0 : i0 + n], b[j, j0 : j0 + n], 0.0
                for k in range(n):
                    sum_ += x[k] * y[k]
                out[r, i, j] = sum_
    return out
