"""How a controller samples its encoder, which descriptions do not state, and the law it then follows on a record."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from sher3_diagnosis.channel import Array
from sher3_effects.operators import held_lag
from sher3_effects.view import StatedLaw

from sher3_chain.joint.description import Axis
from sher3_chain.readings.signals import AxisSignals


class Pace(NamedTuple):
    """How a speed is taken from an encoder.

    Attributes:
        over: periods of the record between the two readings: 1 of a controller that runs at the rate of the log, 2 of
            a calmer one, 1/k and 2/k of those that run k times as fast, and 0 of one that knows its speed from
            elsewhere.
        lag: periods of the low-pass of first order behind it; 0 for none.
    """

    over: float
    lag: float = 0.0

    @property
    def words(self) -> str:
        """How the speed is taken, in words."""
        if self.lag:
            return f"through a low-pass of {self.lag:.2g} periods"
        if 0.0 < self.over < 1.0:
            return f"over {self.over:.2g} of a period: its controller runs faster than the log"
        return {0.0: "about the sample", 1.0: "over one period", 2.0: "over two periods"}[self.over]


LAST, TWO, CENTRAL = Pace(1.0), Pace(2.0), Pace(0.0)
"""Plain paces: over the last period, over the last two, about the sample."""
FASTER = tuple(Pace(2.0 / k) for k in (3, 4, 5, 6, 8, 12, 20, 40))
"""Paces of a controller that runs k times, or half as often, per row of the log: over two of its periods, or one."""


class Sampling(NamedTuple):
    """How a controller samples its encoder.

    Attributes:
        pace: how it takes a speed.
        shift: samples by which it is behind.
    """

    pace: Pace
    shift: int


def stated_law(run: AxisSignals, axis: Axis, sampling: Sampling) -> StatedLaw:
    """Return the stated law on the readings of a run under a sampling; its parts (n, 3) are P, D and I."""
    law, q = axis.command_law, run.motor[:, 0]
    assert run.reference is not None and law.position_gain is not None
    error = run.reference[:, 0] - q
    parts = [law.position_gain * error, -law.velocity_gain * speed_of(q, run.period, sampling.pace)]
    parts.append(law.integral_gain * np.cumsum(error) * run.period)
    late = behind(np.column_stack([*parts, error]), sampling.shift)
    return StatedLaw(late[:, 3], late[:, :3], law.limit or np.inf, law.position_gain)


def behind(x: Array, shift: int) -> Array:
    """Return columns (n, k) that are `shift` samples late; before that they hold their first value."""
    return np.concatenate([x[:1].repeat(shift, axis=0), x])[: len(x)]


def speed_of(q: Array, period: float, pace: Pace) -> Array:
    """Return the speed of a path (n,) as a controller takes it.

    What it read between two rows of the log lies on a cubic spline through them: of parabolas, the error of the speed
    was larger than what tells a half of a period from four tenths.
    """
    if pace.over > 1.0:
        return (q - np.concatenate([q[:1].repeat(2), q[:-2]])) / (2.0 * period)
    last = np.diff(q, prepend=q[0]) / period
    if pace.lag > 0.0:
        return np.append(held_lag(last[:, None], pace.lag, 1.0)[1:, 0], last[-1])
    if pace.over == 1.0:
        return last
    at = period * np.arange(len(q))
    path, step = CubicSpline(at, q), pace.over * period
    return (q - path(at - step)) / step if step else path(at, 1)
