"""Arrays as MATLAB and HDF5 keep them, in the shape of samples."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from sher3_diagnosis.channel import Array

SAMPLES = 20
"""Entries from which a list is one of samples, and no parameter of each joint."""


def plain(x: NDArray[np.generic]) -> Array:
    """Return an array as numbers; a single row (1, n) or column (n, 1) becomes (n,)."""
    y = np.asarray(x, dtype=float)
    return y.ravel() if y.ndim == 2 and 1 in y.shape else y


def stacked(parts: Sequence[Array]) -> Array:
    """Return the one array of a struct, or those of a struct array one after the other.

    Arrays of one shape (...) are stacked to (parts, ...), numbers (1,) to (parts,); others are strung together, (n,).
    """
    if len(parts) == 1:
        return parts[0]
    if len({x.shape for x in parts}) == 1:
        return np.stack([x[0] if x.shape == (1,) else x for x in parts])
    return np.concatenate([x.ravel() for x in parts])
