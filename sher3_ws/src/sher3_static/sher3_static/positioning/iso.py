"""The figures of the standards: ISO 230-2 (positioning) and ISO 230-4 (circles)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array


class Positioning(NamedTuple):
    """Figures of ISO 230-2:2014 for a linear or rotary axis, m or rad; repeatability needs two cycles.

    Attributes:
        accuracy: A, bidirectional accuracy of positioning.
        systematic: E, bidirectional systematic positioning error.
        mean: M, mean bidirectional positioning error.
        reversal: B, largest reversal error.
        repeatability: R, largest bidirectional repeatability.
    """

    accuracy: float
    systematic: float
    mean: float
    reversal: float
    repeatability: float

    def __str__(self) -> str:
        return ", ".join(f"{name} {1e6 * x:.3g}" for name, x in zip("AEMBR", self, strict=True))


def positioning(target: Array, deviation: Array, direction: Array) -> Positioning:
    """Return the figures of a test.

    Args:
        target: (n,) m or rad.
        deviation: (n,) reading less target.
        direction: (n,) side of the approach, +1 or -1. With one side only, B is zero.
    """
    means, sides, reversal, repeat = [], [], [], []
    for at in np.unique(target):
        both = [deviation[(target == at) & (direction == d)] for d in (1.0, -1.0)]
        mean = [float(x.mean()) for x in both if len(x)]
        spread = [float(x.std(ddof=1)) if len(x) > 1 else 0.0 for x in both if len(x)]
        step = mean[0] - mean[1] if len(mean) == 2 else 0.0
        means.append(float(np.mean(mean)))
        reversal.append(abs(step))
        repeat.append(max(2.0 * sum(spread) + abs(step) if len(mean) == 2 else 0.0, *(4.0 * s for s in spread)))
        sides += [(m, m - 2.0 * s, m + 2.0 * s) for m, s in zip(mean, spread, strict=True)]
    middle, low, high = np.array(sides).T
    return Positioning(
        accuracy=float(high.max() - low.min()),
        systematic=float(np.ptp(middle)),
        mean=float(np.ptp(means)),
        reversal=max(reversal),
        repeatability=max(repeat),
    )


class Circular(NamedTuple):
    """Figures of ISO 230-4, m.

    Attributes:
        both: G(b), bidirectional circular deviation: the ring that holds the path of both senses.
        forward, backward: G of the counter-clockwise and of the clockwise path; nan where it was not driven.
    """

    both: float
    forward: float
    backward: float

    def __str__(self) -> str:
        named = zip(("G(b)", "G(xy)", "G(yx)"), self, strict=True)
        return ", ".join(f"{name} {1e6 * x:.3g}" for name, x in named if np.isfinite(x))


def circular(angle: Array, radius: Array, turning: Array) -> Circular:
    """Return the figures of a circle about its least-squares centre.

    Args:
        angle: (n,) rad.
        radius: (n,) m.
        turning: (n,) +1 counter-clockwise, -1 clockwise.
    """
    x = np.column_stack([np.ones(len(angle)), np.cos(angle), np.sin(angle)])
    left = radius - x @ np.linalg.lstsq(x, radius, rcond=None)[0]
    one = [float(np.ptp(left[turning == sense])) if (turning == sense).any() else float("nan") for sense in (1.0, -1.0)]
    return Circular(float(np.ptp(left)), *one)
