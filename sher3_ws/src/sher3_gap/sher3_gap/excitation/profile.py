"""Smooth building blocks of set-points: every track is twice continuously differentiable in position.

The blend is the minimum-jerk quintic 10 x^3 - 15 x^4 + 6 x^5 (Flash and Hogan 1985).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.floating[Any]]

PEAK_SLOPE = 1.875
"""Largest slope of the blend: peak velocity of a move of length d in time T is 1.875 d / T."""
PEAK_CURVATURE = 10 / math.sqrt(3)
"""Largest curvature of the blend: peak acceleration of that move is 5.77 d / T^2."""


@dataclass(frozen=True)
class Move:
    """One rest-to-rest move: starts at `start` [s], takes `duration` [s], travels `distance` (m or rad)."""

    start: float
    duration: float
    distance: float


@dataclass(frozen=True)
class SpeedChange:
    """A blend from one constant speed to another: `step` (m/s or rad/s) between `start` and `start + duration` [s]."""

    start: float
    duration: float
    step: float


def shortest_move(distance: float, velocity: float, acceleration: float) -> float:
    """Return the least duration [s] of a minimum-jerk move of `distance` within peak velocity and acceleration."""
    d = abs(distance)
    return max(PEAK_SLOPE * d / velocity, math.sqrt(PEAK_CURVATURE * d / acceleration))


def shortest_speed_change(step: float, acceleration: float) -> float:
    """Return the least duration [s] of a blended speed change of `step` within the peak acceleration."""
    return PEAK_SLOPE * abs(step) / acceleration


def move_track(time: FloatArray, moves: Sequence[Move]) -> tuple[FloatArray, FloatArray]:
    """Return displacement and velocity (n,) at `time` (n,) [s] of a sequence of moves; overlapping moves add up."""
    q, v = np.zeros_like(time), np.zeros_like(time)
    for move in moves:
        x = np.clip((time - move.start) / move.duration, 0.0, 1.0)
        q += move.distance * x**3 * (10 - 15 * x + 6 * x * x)
        v += move.distance / move.duration * 30 * x * x * (1 - x) ** 2
    return q, v


def speed_track(time: FloatArray, changes: Sequence[SpeedChange]) -> tuple[FloatArray, FloatArray]:
    """Return displacement and velocity (n,) at `time` (n,) [s] of a sequence of speed changes, from rest."""
    q, v = np.zeros_like(time), np.zeros_like(time)
    for change in changes:
        s = (time - change.start) / change.duration
        x = np.clip(s, 0.0, 1.0)
        v += change.step * x**3 * (10 - 15 * x + 6 * x * x)
        q += change.step * change.duration * (x**4 * (2.5 - 3 * x + x * x) + np.maximum(s - 1.0, 0.0))
    return q, v
