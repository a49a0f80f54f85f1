"""Where a fault sits, and what its magnitude is there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_description import ACTUATORS

ANGULAR = {"length": 31.4, "force": 0.025, "stiffness": 8e-4, "compliance": 1256.0, "speed": 98.0, "inertia": 2e-3}
"""What one unit of a slider becomes on the roll axis, by ratio of encoder steps, rated forces and speed limits."""


@dataclass(frozen=True)
class Site:
    """Where a fault sits and how its kind scales there.

    Attributes:
        actuator: an actuator, or `tip`, `force_sensor`, `all`.
        rng: draws the fault's shape (phase, period, direction); the same every time the fault is applied.
    """

    actuator: str
    rng: np.random.Generator

    @property
    def index(self) -> int:
        """Index of the actuator; all others are errors."""
        return ACTUATORS.index(self.actuator)

    @property
    def rows(self) -> slice:
        """Rows of an array that the fault changes: of one actuator, or all."""
        return slice(self.index, self.index + 1) if self.actuator in ACTUATORS else slice(None)

    def scaled(self, value: float, dimension: str) -> float:
        """Return a slider's value in the actuator's unit."""
        return value * ANGULAR[dimension] if self.actuator == "roll" else value

    def sign(self) -> float:
        """Return +1 or -1."""
        return float(self.rng.choice([-1.0, 1.0]))

    def direction(self, dimensions: int = 3) -> NDArray[np.floating[Any]]:
        """Return a random unit vector (dimensions,)."""
        v = self.rng.standard_normal(dimensions)
        return np.asarray(v / np.linalg.norm(v))
