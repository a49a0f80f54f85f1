"""What repeats differ by: the floor below which a gap is no gap.

Per channel and component F = mean((y_a - y_b)^2) / 2 over pairs of runs with the same excitation (recorded-run
contract, section 8).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from itertools import combinations

import numpy as np

from sher3_diagnosis.channel import Array, Channel, Floors, Residual, Residuals

GAUSSIAN = 1.4826
"""Standard deviation over the median of absolute values, of a normal distribution."""
UNIFORM = np.sqrt(12.0)
"""Width of a uniform distribution over its standard deviation: a count over the error of rounding to it."""
BEND = np.sqrt(6.0)
"""Standard deviation of second differences of white noise over that of the noise: 1 + 4 + 1 under the root."""
ENOUGH = 50
"""Samples shared by pairs of repeats below which they tell no floor."""


def noise_of_bends(bends: Array) -> Array:
    """Return the standard deviation (...) of the white noise that second differences (n, ...) of a signal are made of.

    The median leaves reversals and steps out.
    """
    return np.asarray(GAUSSIAN * np.median(np.abs(bends), axis=0) / BEND)


def repeat_floors(excitations: Sequence[str], residuals: Sequence[Residuals]) -> Floors:
    """Return the floor from pairs of repeats, pooled over excitations; channels without repeats are absent.

    Args:
        excitations: per run, its name; runs of one name are repeats.
        residuals: per run.
    """
    groups: dict[str, list[int]] = defaultdict(list)
    for i, excitation in enumerate(excitations):
        groups[excitation].append(i)
    total: dict[Channel, Array] = {}
    count: dict[Channel, int] = defaultdict(int)
    for a, b in (pair for members in groups.values() for pair in combinations(members, 2)):
        for channel in residuals[a].keys() & residuals[b].keys():
            x, y = residuals[a][channel], residuals[b][channel]
            n = min(len(x.values), len(y.values))
            ok = x.ok[:n] & y.ok[:n]
            apart = x.relieved((x.values[:n] - y.values[:n])[ok], ok)
            total[channel] = total.get(channel, 0.0) + 0.5 * np.sum(apart**2, axis=0)
            count[channel] += int(ok.sum())
    return {c: np.sqrt(t / count[c]) for c, t in total.items() if count[c] > ENOUGH}


def relieved_rms(residual: Residual) -> Array:
    """Return the root mean square of a residual relieved of its free mean, (d,)."""
    return np.sqrt(np.mean(residual.relieved(residual.values[residual.ok]) ** 2, axis=0))
