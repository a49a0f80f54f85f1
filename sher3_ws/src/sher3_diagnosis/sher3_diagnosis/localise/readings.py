"""How noisy readings are: the white noise of their samples, rounding to a count included."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sher3_diagnosis.channel import Array
from sher3_diagnosis.localise.floors import GAUSSIAN, UNIFORM
from sher3_diagnosis.verdict import Noise

ORDER = 5
"""Difference of the readings that leaves its noise alone: what moves slowly against the samples is gone in it."""
TOP = 0.85
"""Share of the Nyquist frequency from which nothing of the motion is left."""
SHORTEST = 64
"""Samples below which a record has too few frequencies."""
ROUNDING = 1e-9
"""Share of their span below which noise of readings is that of the arithmetic of a simulator."""


def noise_in(place: str, reading: str, unit: str, records: Sequence[Array], resolution: float = 0.0) -> Noise:
    """Return the noise of one kind of reading over records (n,) of one unit, rms over them.

    Args:
        place: actuator or sensor that is read.
        reading: what is read, such as `position` or `effort`.
        unit: of the readings and their resolution.
        records: readings of each record.
        resolution: step of the readings; 0 where they show none.
    """
    sizes = [size if (size := noise_of(x)) > ROUNDING * np.ptp(x) else 0.0 for x in records]
    deviation = max(float(np.sqrt(np.mean(np.square(sizes)))), resolution / UNIFORM)
    return Noise(actuator=place, reading=reading, deviation=deviation, resolution=resolution or None, unit=unit)


def noise_of(readings: Array, resolution: float = 0.0) -> float:
    """Return the standard deviation of white noise in readings (n,): of two figures that hold too much the smaller.

    It is no less than that of rounding to their `resolution`.

    The noise of a fifth difference has the sum of squares of the binomial coefficients in power; in a slow record it
    holds motion too, which the highest frequencies do not.
    """
    power = math.comb(2 * ORDER, ORDER)
    bend = np.diff(readings, ORDER)
    size = GAUSSIAN * float(np.median(np.abs(bend))) / np.sqrt(power)
    return max(min(size, noise_at_the_top(readings)), resolution / UNIFORM)


def noise_at_the_top(readings: Array) -> float:
    """Return the standard deviation of white noise in readings (n,) that has the power of its highest frequencies."""
    n = len(readings)
    if n < SHORTEST:
        return np.inf
    window = np.hanning(n)
    clock, moved = np.arange(n) - 0.5 * (n - 1), readings - readings.mean()
    line = (clock @ moved) / (clock @ clock) * clock
    power = np.abs(np.fft.rfft((moved - line) * window)) ** 2 / np.sum(window**2)
    return float(np.sqrt(np.mean(power[int(TOP * len(power)) :])))
