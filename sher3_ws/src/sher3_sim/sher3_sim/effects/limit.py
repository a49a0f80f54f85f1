"""Limits inside the drive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sher3_sim.effects.base import EVERYWHERE, Effect, parameter
from sher3_sim.parameters import PlantParameters


@dataclass(frozen=True)
class ForceSaturation(Effect, id="force_saturation", family="limit", stage="drive"):
    """The drive's force ends earlier than its data sheet says: current limit, supply, temperature derating."""

    limit: float = parameter("N", 20.0, 0.5, 200.0, "largest force of the drive")

    def apply(self, p: PlantParameters) -> None:
        """Lower the force limit."""
        p.axis["limit"][self.rows] = np.minimum(p.axis["limit"][self.rows], self.limit)


@dataclass(frozen=True)
class VelocityDeadband(Effect, id="velocity_deadband", family="limit", stage="drive", places=EVERYWHERE):
    """The drive takes a demand within +-width for zero, behind the echo: resolution or a standstill window."""

    width: float = parameter("m/s", 1e-4, 0.0, 5e-3, "half width of the dead zone")

    def apply(self, p: PlantParameters) -> None:
        """Widen the dead zone of the demand."""
        p.axis["deadband"][self.rows] = np.maximum(p.axis["deadband"][self.rows], self.width)
