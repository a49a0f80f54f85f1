"""Counter-based random numbers for the compiled plant.

A draw is a pure function of (seed, stream, index), so it is the same whatever else the plant does: two runs that differ
in one effect share every other noise sample, and a saved state resumes bit for bit.
"""

from __future__ import annotations

import math

import numpy as np
from sher3_common.compiled import compiled

_STEP = np.uint64(0x9E3779B97F4A7C15)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_STREAM = np.uint64(0xD1342543DE82EF95)

EFFORT, FORCE, TRACKER, JITTER, DROP, DISTURBANCE = 0, 8, 16, 24, 25, 32


@compiled(inline="always")
def _mix(x):
    """Finaliser of splitmix64 (Steele, Lea, Flood 2014)."""
    x = (x ^ (x >> np.uint64(30))) * _MIX_1
    x = (x ^ (x >> np.uint64(27))) * _MIX_2
    return x ^ (x >> np.uint64(31))


@compiled
def uniform(seed: int, stream: int, index: int) -> float:
    """Return a uniform number in (0, 1)."""
    x = _mix(np.uint64(seed) + np.uint64(stream + 1) * _STREAM)
    x = _mix(x + np.uint64(index + 1) * _STEP)
    return (np.float64(x >> np.uint64(11)) + 0.5) * 1.1102230246251565e-16


@compiled
def normal(seed: int, stream: int, index: int) -> float:
    """Return a standard normal number, by Box and Muller's transform of two uniform ones."""
    radius = math.sqrt(-2.0 * math.log(uniform(seed, stream, 2 * index)))
    return radius * math.cos(2.0 * math.pi * uniform(seed, stream, 2 * index + 1))
