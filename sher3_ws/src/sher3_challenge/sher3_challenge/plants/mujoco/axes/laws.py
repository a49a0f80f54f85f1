"""Friction levels and forces that change with position, speed or time, where MuJoCo has a constant.

They are called at every substep and written into the model (`dof_frictionloss`) or onto the joint (`qfrc_applied`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Constant:
    """Friction of one level."""

    force: float

    def __call__(self, q: float, v: float, t: float) -> float:
        """Return the level."""
        return self.force


@dataclass(frozen=True)
class Bent:
    """A law that differs from its page by a factor 1 + size sin(rate q + quick v + phase)."""

    law: Callable[[float, float, float], float]
    size: float
    rate: float
    quick: float
    phase: float

    def __call__(self, q: float, v: float, t: float) -> float:
        """Return the law's value with its factor."""
        return self.law(q, v, t) * (1 + self.size * math.sin(self.rate * q + self.quick * v + self.phase))


@dataclass(frozen=True)
class Film:
    """Friction whose lubricating film carries more of it with speed: (1 + (v / velocity)^2)^-1, no Gaussian."""

    force: float
    velocity: float

    def __call__(self, q: float, v: float, t: float) -> float:
        """Return the part the film does not carry."""
        return self.force / (1 + (v / self.velocity) ** 2)


@dataclass(frozen=True)
class Guide:
    """Friction between a ninth of `force` and `force` along a wavy guide whose crests are narrower than its hollows."""

    force: float
    period: float
    phase: float
    peak: float = 0.25

    @property
    def mean(self) -> float:
        """Mean of the level: (1 + cos x + peak cos 2x) has that of one."""
        return self.force / (2 + self.peak)

    def __call__(self, q: float, v: float, t: float) -> float:
        """Return the level at position `q`."""
        x = 2 * math.pi * q / self.period + self.phase
        return max(0.0, self.mean * (1 + math.cos(x) + self.peak * math.cos(2 * x)))


@dataclass(frozen=True)
class Grease:
    """Friction that runs in: three quarters fast, one quarter three times slower; `time` is when 1/e of it is left."""

    force: float
    time: float

    def __call__(self, q: float, v: float, t: float) -> float:
        """Return the level after `t` seconds."""
        x = t / (GREASE_SHARE * self.time)
        return self.force * (0.75 * math.exp(-x) + 0.25 * math.exp(-x / 3))


GREASE_SHARE = 0.77243
"""Fast time constant over the time to 1/e: 0.75 exp(-x) + 0.25 exp(-x/3) = 1/e at x = 1/0.77243."""


@dataclass(frozen=True)
class Poles:
    """Cogging of poles with narrow slots: a sine with a tenth of its third harmonic."""

    amplitude: float
    period: float
    phase: float

    def __call__(self, q: float, v: float, t: float) -> float:
        """Return the force at position `q`."""
        x = 2 * math.pi * q / self.period + self.phase
        return -self.amplitude * (math.sin(x) + 0.1 * math.sin(3 * x))


@dataclass(frozen=True)
class Magnet:
    """A latch magnet beside the rail: it pulls towards its place, most at 0.58 of its reach."""

    force: float
    place: float
    reach: float

    def __call__(self, q: float, v: float, t: float) -> float:
        """Return the force at position `q`; the factor makes the largest one `force`."""
        x = (q - self.place) / self.reach
        return -self.force * 3.0792 * x / (1 + x * x) ** 2
