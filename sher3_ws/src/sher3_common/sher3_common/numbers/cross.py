"""Cross products of many vectors, bit for bit those of `numpy.cross`, which takes 0.1 ms to find the axes of each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def cross(a: Array, b: Array) -> Array:
    """Return the cross products (..., 3) of vectors (..., 3), which may be broadcast against each other."""
    ax, ay, az, bx, by, bz = (x[..., i] for x in (a, b) for i in range(3))
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=-1)


def skew(x: Array) -> Array:
    """Return the matrices (n, 3, 3) that times y are the cross products of x (n, 3) and y."""
    out = np.zeros((len(x), 3, 3))
    out[:, 0, 1], out[:, 0, 2], out[:, 1, 2] = -x[:, 2], x[:, 1], -x[:, 0]
    return out - out.transpose(0, 2, 1)
