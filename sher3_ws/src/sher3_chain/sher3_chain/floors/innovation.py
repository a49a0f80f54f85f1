"""Floors of residuals: between repeats where there are any, else their innovation; never below the resolution."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import TypeVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Floors, Residual, Residuals
from sher3_diagnosis.filter import low_pass
from sher3_diagnosis.localise.floors import noise_of_bends, repeat_floors
from sher3_effects.operators import second_difference

from sher3_chain.chain.view import ChainView
from sher3_chain.readings.signals import AxisSignals

V = TypeVar("V", bound=ChainView)
NOISE_SAMPLES = 400
"""Samples of simulated noise at least, so that its filtered power is known to a few per cent."""
ON_GRID = 20
"""Samples of the residual grid at least, where a record is so short that it has hardly any."""
NOTHING = 1e-12
"""Floor in place of none, N or N m."""


def chain_floors(
    records: Sequence[V],
    found: Sequence[Residuals],
    repeats: bool,
    least: Callable[[V], Floors],
    unforeseen: Callable[[V, Residual, Channel], Array],
) -> list[Floors]:
    """Return the floor per record and channel.

    Args:
        records: views of a chain.
        found: residuals of each record.
        repeats: whether the records are repeats of one motion.
        least: floors that the readings' own resolution makes, (1,) each in the unit of the residual.
        unforeseen: the part (1,) of a residual that its past and known inputs cannot foresee.
    """
    pooled = repeat_floors([view.excitation for view in records], found) if repeats else {}
    out = []
    for view, residuals in zip(records, found, strict=True):
        rounded = least(view)
        out.append({c: np.maximum(pooled.get(c, unforeseen(view, x, c)), rounded[c]) for c, x in residuals.items()})
    return out


def plain_innovation(view: ChainView, residual: Residual, channel: Channel) -> Array:
    """Return the standard deviation (1,) of white noise whose innovation is that of a residual, in its unit."""
    return innovation(residual) / foresight(view.run)


def foresight(run: AxisSignals) -> float:
    """Return the innovation of white noise after the filter of the residuals over its standard deviation, 0.7 to 1.

    The filter makes neighbours alike, so that they foresee a part of the noise.
    """
    return _white_noise_innovation(run.ticks, run.stride, run.period, run.bandwidth)


@lru_cache(maxsize=64)
def _white_noise_innovation(ticks: int, stride: int, period: float, bandwidth: float) -> float:
    noise = np.random.default_rng(0).normal(size=(max(ticks, NOISE_SAMPLES, ON_GRID * stride), 1))
    seen = low_pass(noise, period, bandwidth)[::stride]
    return float(innovation(Residual(seen, np.ones(len(seen), dtype=bool)))[0] / seen.std())


def white_behind(run: AxisSignals) -> tuple[float, float, float]:
    """Return the standard deviation of white noise behind a run's filter, of its speed, 1/s, and acceleration, 1/s^2.

    All are those of noise of a standard deviation of one, without the ends, where the filter spoils a difference.
    """
    noise = np.random.default_rng(0).normal(size=(max(run.ticks, NOISE_SAMPLES), 1))
    end = min(int(run.edge), len(noise) // 4)
    kinds = (noise, np.gradient(noise, run.period, axis=0), second_difference(noise, run.period))
    place, pace, bend = (float(run.filtered(x)[end : len(noise) - end].std()) for x in kinds)
    return place, pace, bend


def innovation(residual: Residual) -> Array:
    """Return the rms (d,) by which samples of a residual depart from a straight line through their neighbours."""
    return noise_of_bends(np.diff(residual.values[residual.ok], 2, axis=0))
