"""A cubic spline through poses at equal distances along a path, `scipy.interpolate.CubicSpline` without its import.

Importing that takes a third of the start of `sher3 up`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Spline:
    """The curve on 0..1: on piece k it is a polynomial in (s - s_k) with `coefficients[:, k]`, (4, pieces, d)."""

    coefficients: Array

    def __call__(self, s: float | Array, order: int = 0) -> Array:
        """Return the curve (..., d), or its derivative of this order, at s (...)."""
        c, pieces = self.coefficients, self.coefficients.shape[1]
        k = np.clip((np.asarray(s) * pieces).astype(int), 0, pieces - 1)
        x = (np.asarray(s) - k / pieces)[..., None]
        if order == 0:
            result = c[0, k] + x * (c[1, k] + x * (c[2, k] + x * c[3, k]))
        elif order == 1:
            result = c[1, k] + x * (2.0 * c[2, k] + 3.0 * x * c[3, k])
        else:
            result = 2.0 * c[2, k] + 6.0 * x * c[3, k]
        return np.asarray(result)


def spline_through(nodes: Array) -> Spline:
    """Return the spline through nodes (n, d) at s = 0, 1 / (n - 1), ..., 1, n at least 4.

    Its first and its last two pieces are one polynomial each ("not a knot": de Boor, "A Practical Guide to Splines",
    1978, ch. IV). The unknowns are the slopes at the nodes.
    """
    n = len(nodes)
    h = 1.0 / (n - 1)
    chord = np.diff(nodes, axis=0) / h
    matrix = 4.0 * np.eye(n) + np.eye(n, k=1) + np.eye(n, k=-1)
    right = np.empty_like(nodes)
    right[1:-1] = 3.0 * (chord[:-1] + chord[1:])
    for row, sign in ((0, 1), (n - 1, -1)):
        matrix[row] = 0.0
        matrix[row, row], matrix[row, row + 2 * sign] = 1.0, -1.0
        first, second = (0, 1) if row == 0 else (n - 2, n - 3)
        right[row] = 2.0 * (chord[first] - chord[second])
    slope = np.linalg.solve(matrix, right)
    third = (slope[:-1] + slope[1:] - 2.0 * chord) / h**2
    return Spline(np.stack([nodes[:-1], slope[:-1], (chord - slope[:-1]) / h - third * h, third]))
