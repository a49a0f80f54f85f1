"""Periods per turn of a joint that stand out in what was read of it over its angle: a force, or a second encoder."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.filter import BANDWIDTH

LEAST = 2.0
"""Periods within the travel from which a wave is told from what else follows the position: a spring, a cable, a weight.
"""
FINE = 4.0
"""Orders that are tried within the width of a peak, which is one period more or less over the travel."""
MOST = 2000
"""Orders that are tried at most."""


def orders_in(reading: Array, position: Array, speed: Array, count: int) -> list[float]:
    """Return the periods per turn, or per 2 pi m, whose waves take most of a reading, the strongest of each peak first.

    A constant, the position, the speed and its sign are taken off before: whatever a joint has beside a wave.

    Args:
        reading: (n,) N m or N, rad or m.
        position: (n,) of the joint, m or rad.
        speed: (n,) of the joint, m/s or rad/s.
        count: of orders that are returned at most.
    """
    travel = float(np.ptp(position)) if len(position) else 0.0
    quick = float(np.median(np.abs(speed))) if len(speed) else 0.0
    if travel <= 0.0 or quick <= 0.0:
        return []
    turn, top = 2.0 * np.pi / travel, 2.0 * np.pi * BANDWIDTH / quick
    tried = int(min(max(FINE * (top / turn - LEAST), 0.0), MOST))  # an axis at rest is slow without end
    orders = turn * (LEAST + np.arange(tried) / FINE)
    plain = np.column_stack([np.ones_like(position), position, speed, np.sign(speed)])
    left = reading - plain @ np.linalg.lstsq(plain, reading, rcond=None)[0]
    power = np.empty(tried)
    wave, finer = (np.exp(-1j * turn * n * position) for n in (LEAST, 1.0 / FINE))
    for i in range(tried):  # the next wave is this one, turned by a quarter of a period over the travel
        power[i], wave = np.abs(wave @ left), wave * finer
    inner = np.r_[-np.inf, power, -np.inf]
    peaks = np.flatnonzero((inner[1:-1] >= inner[:-2]) & (inner[1:-1] >= inner[2:]))
    return [float(orders[i]) for i in peaks[np.argsort(-power[peaks])][:count]]
