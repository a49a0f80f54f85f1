"""Transport of commands: delays that waver, lateness from an empirical distribution, losses in bursts."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sher3_challenge.plants.plant import AXES, Array

LATENESS = np.interp(np.linspace(0, 1, 65), [0, 0.1, 0.5, 0.8, 0.95, 1], [0.0, 0.25, 0.75, 1.2, 2.0, 3.6])
"""Quantiles of a command's lateness over its scale, as measured on a busy bus: never quite none, with a long tail."""
LATENESS /= np.sqrt(np.mean(np.interp(np.linspace(0, 1, 4001), np.linspace(0, 1, 65), LATENESS) ** 2))
WAVER = 0.02
"""Share by which a constant delay wavers slowly."""
BURST = 1.6
"""Mean number of commands lost in a row."""


@dataclass
class Transport:
    """Delay per axis [s], rms of a random lateness [s], share of commands that are lost."""

    delay: Array = field(default_factory=lambda: np.zeros(AXES))
    lateness: float = 0.0
    loss: float = 0.0

    def arrivals(self, ticks: int, period: float, rng: np.random.Generator) -> Array:
        """Return (ticks, 5) times of arrival [s] from the start, inf where a command is lost; none overtakes."""
        tick = np.arange(ticks)
        drawn = np.interp(rng.random(ticks), np.linspace(0, 1, len(LATENESS)), LATENESS)
        slow = 1 + WAVER * np.sin(2 * np.pi * (tick * period * 0.7 + rng.random()))
        late = np.minimum(self.lateness * drawn, 5 * period)
        arrival = (tick * period)[:, None] + late[:, None] + slow[:, None] * self.delay
        arrival = np.maximum.accumulate(arrival, axis=0)
        lost = np.zeros(ticks, dtype=bool)
        if self.loss > 0.0:
            begins = rng.random(ticks) < self.loss / BURST
            for start in np.flatnonzero(begins):
                lost[start : start + rng.geometric(1 / BURST)] = True
        lost[0] = False
        arrival[lost] = np.inf
        return np.asarray(arrival)
