"""Wheels and discs that turn off their centre: what they add to a position."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class Eccentric:
    """What an eccentric wheel or disc adds once per turn of its phase: the angle of a circle seen off its centre.

    Its first harmonic has exactly `amplitude`; the second has half the share `eccentricity` of it.
    """

    amplitude: float
    period: float
    phase: float
    eccentricity: float = 0.1

    def __call__(self, q: float) -> float:
        """Return what is added at position `q`."""
        turn = 2 * math.pi * q / self.period + self.phase
        e = self.eccentricity
        return self.amplitude * math.atan2(e * math.sin(turn), 1 + e * math.cos(turn)) / e


class Eccentrics:
    """Many eccentric wheels at once."""

    def __init__(self, wheels: Sequence[tuple[int, Eccentric]], axes: int) -> None:
        """Take wheels with the index of the axis, of so many, that each turns with."""
        self.axis = np.array([j for j, _ in wheels], dtype=int)
        self.rate = np.array([2 * math.pi / w.period for _, w in wheels])
        self.phase = np.array([w.phase for _, w in wheels])
        self.share = np.array([w.eccentricity for _, w in wheels])
        self.onto = np.zeros((axes, len(wheels)))
        for i, (j, w) in enumerate(wheels):
            self.onto[j, i] = w.amplitude / w.eccentricity

    def __call__(self, q: Array) -> Array:
        """Return (..., 5) what the wheels add at positions (..., 5)."""
        turn = self.rate * q[..., self.axis] + self.phase
        seen = np.arctan2(self.share * np.sin(turn), 1 + self.share * np.cos(turn))
        return np.asarray(seen @ self.onto.T)
