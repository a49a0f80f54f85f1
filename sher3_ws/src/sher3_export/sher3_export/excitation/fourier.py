"""Periodic motion of several joints as finite Fourier series that begin and end at rest (Swevers et al., 1997)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array


class Box(NamedTuple):
    """What k joints may do; (k,) each, m or rad, per s and per s^2."""

    low: Array
    high: Array
    speed: Array
    acceleration: Array


@dataclass(frozen=True)
class Fourier:
    """q(t) = centre + sum of sine_h sin(h w t) + cosine_h cos(h w t), w = 2 pi / seconds.

    Attributes:
        seconds: of a period.
        centre: (k,) m or rad.
        sine, cosine: (k, harmonics).
    """

    seconds: float
    centre: Array
    sine: Array
    cosine: Array

    def motion(self, t: Array) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration at times t (n,), (n, k) each."""
        w = 2.0 * np.pi / self.seconds * np.arange(1, self.sine.shape[1] + 1)
        s, c = np.sin(np.outer(t, w)), np.cos(np.outer(t, w))
        q = self.centre + s @ self.sine.T + c @ self.cosine.T
        v = c @ (w * self.sine).T - s @ (w * self.cosine).T
        return q, v, -s @ (w**2 * self.sine).T - c @ (w**2 * self.cosine).T


def drawn(rng: np.random.Generator, joints: int, harmonics: int, seconds: float) -> Fourier:
    """Draw a motion of any size that begins at rest: no velocity (sum of h sine_h) and no acceleration (h^2 cosine_h).

    High harmonics are drawn smaller, since accelerations grow with their square.
    """
    h = np.arange(1, harmonics + 1)
    sine, cosine = rng.normal(size=(2, joints, harmonics)) / h
    sine -= np.outer(sine @ h, h) / (h @ h)
    cosine -= np.outer(cosine @ h**2, h**2) / (h**2 @ h**2)
    return Fourier(seconds, np.zeros(joints), sine, cosine)


def within(motion: Fourier, box: Box, t: Array) -> Fourier:
    """Return a motion, at times t (n,) s, of a size and centre with which each joint just meets one of its limits."""
    q, v, a = motion.motion(t)
    room = box.high - box.low
    share = np.stack(
        [room / np.ptp(q, axis=0), box.speed / np.abs(v).max(axis=0), box.acceleration / np.abs(a).max(axis=0)]
    )
    size = share.min(axis=0)
    middle = 0.5 * (q.max(axis=0) + q.min(axis=0))
    centre = 0.5 * (box.high + box.low) - size * (middle - motion.centre)
    return Fourier(motion.seconds, centre, size[:, None] * motion.sine, size[:, None] * motion.cosine)
