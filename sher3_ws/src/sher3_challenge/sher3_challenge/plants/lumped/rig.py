"""What a fault of the lumped plant may change."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from sher3_description import Robot

from sher3_challenge.plants.grammar import NOTHING, Foreign
from sher3_challenge.plants.lumped.parameters import AXES, Array, TruthParameters


@dataclass
class Timing:
    """Transport of commands: fixed delay per axis [s], spread of a random one [s], probability of loss."""

    delay: Array = field(default_factory=lambda: np.zeros(AXES))
    jitter: float = 0.0
    loss: float = 0.0

    def draw(self, ticks: int, period: float, rng: np.random.Generator) -> Array:
        """Return (ticks, 5) delays from tick to arrival; inf where the command is lost. Commands never overtake."""
        common = np.minimum(np.abs(self.jitter * rng.standard_normal(ticks)), 5 * period)
        arrival = np.arange(ticks)[:, None] * period + common[:, None] + self.delay
        arrival = np.maximum.accumulate(arrival, axis=0) - np.arange(ticks)[:, None] * period
        arrival[rng.random(ticks) < self.loss] = np.inf
        arrival[0] = np.where(np.isinf(arrival[0]), 0.0, arrival[0])
        return np.asarray(arrival)


@dataclass
class Rig:
    """Parameters and transport of one run. `region` is where the runs work, for local faults."""

    robot: Robot
    truth: TruthParameters
    timing: Timing = field(default_factory=Timing)
    foreign: Foreign = NOTHING
    region: Array = field(default_factory=lambda: np.zeros(AXES))
