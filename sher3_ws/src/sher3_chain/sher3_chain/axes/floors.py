"""Floors of an axis: between repeats where there are any, else what no model could foresee, and never below a count."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Floors, Residual, Residuals
from sher3_diagnosis.localise.floors import repeat_floors
from sher3_diagnosis.thresholds import EATEN

from sher3_chain.axes.foreseen import foreseen
from sher3_chain.axes.view import AxisView
from sher3_chain.readings.noise import GAUSSIAN
from sher3_chain.readings.signals import AxisSignals

BEND = np.sqrt(6.0)
"""Standard deviation of second differences of white noise over that of the noise: 1 + 4 + 1 under the root."""
UNIFORM = np.sqrt(12.0)
"""Width of a uniform distribution over its standard deviation: a count over the error of rounding to it."""
NOISE_SAMPLES = 400
"""Samples of simulated noise at least, so that its filtered power is known to a few per cent."""
ON_GRID = 20
"""Samples of the residual grid at least, where a record is so short that it has hardly any."""
NOTHING = 1e-12
"""Floor in place of none, N or N m."""


def floors_of(records: Sequence[AxisView], found: Sequence[Residuals], repeats: bool) -> list[Floors]:
    """Return the floor per record and channel.

    Args:
        records: of one axis.
        found: residuals of each record.
        repeats: whether the records are repeats of one motion.
    """
    pooled = repeat_floors([view.excitation for view in records], found) if repeats else {}
    out = []
    for view, residuals in zip(records, found, strict=True):
        least = resolution_floors(view)
        out.append({c: np.maximum(pooled.get(c, unforeseen(view, x, c)), least[c]) for c, x in residuals.items()})
    return out


def unforeseen(view: AxisView, residual: Residual, channel: Channel) -> Array:
    """Return the noise, (1,), of which as much cannot be foreseen as of a residual.

    Where a straight line leaves more of a driven axis than `EATEN`, known inputs are asked as well. What they foresee
    of the encoder's own noise, which two differences make alike from sample to sample, is noise all the same.
    """
    plain = innovation(residual) / foresight(view.run)
    signal = np.sqrt(np.mean(residual.values[residual.ok] ** 2, axis=0))
    if view.described.free or not (plain > EATEN * signal).any():
        return plain
    noise = resolution_floors(view, UNIFORM * view.noise)[channel]
    return np.minimum(plain, np.maximum(foreseen(view.run, residual), noise))


def foresight(run: AxisSignals) -> float:
    """Return the innovation of white noise after the filter of the residuals over its standard deviation, 0.7 to 1.

    The filter makes neighbours alike, so that a part of what is noise could be foreseen from them.
    """
    noise = np.random.default_rng(0).normal(size=(max(run.ticks, NOISE_SAMPLES, ON_GRID * run.stride), 1))
    seen = run.filtered(noise)[:: run.stride]
    return float(innovation(Residual(seen, np.ones(len(seen), dtype=bool)))[0] / seen.std())


def resolution_floors(view: AxisView, least: float = 0.0) -> Floors:
    """Return what rounding alone makes: white noise of a count's variance through the filters of the residuals.

    The count, m or rad, is taken to be no smaller than `least`.
    """
    run, axis = view.run, view.described
    count = max(axis.encoder_resolution, least) / UNIFORM
    noise = np.random.default_rng(0).normal(size=(max(run.ticks, NOISE_SAMPLES), 1))
    bend = np.zeros_like(noise)
    bend[1:-1] = np.diff(noise, 2, axis=0) / run.period**2
    effort = axis.effort_resolution / UNIFORM * float(run.filtered(noise).std())
    inertia = view.mass * count * float(run.filtered(bend).std())
    force = count if axis.servo else max(float(np.hypot(effort, inertia)), NOTHING)
    return {
        Channel("motor_mechanics", axis.name): np.array([max(force, NOTHING)]),
        Channel("transmission", axis.name): np.array([np.sqrt(2.0) * count]),
    }


def innovation(residual: Residual) -> Array:
    """Return what neighbouring samples of a residual differ by beyond a straight line, (d,): what cannot be foreseen.

    The median leaves reversals and steps out.
    """
    bend = np.diff(residual.values[residual.ok], 2, axis=0)
    return GAUSSIAN * np.median(np.abs(bend), axis=0) / BEND
