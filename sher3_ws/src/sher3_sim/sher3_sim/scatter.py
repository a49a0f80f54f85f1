"""What differs between two runs of the same commands on the same robot: a gap smaller than this is no gap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sher3_sim.parameters import PlantParameters


@dataclass(frozen=True)
class RunScatter:
    """Run-to-run variation, each value one standard deviation; every seed gives a new draw.

    Attributes:
        start: Of the start position [motor counts].
        zero: Of the load encoder's zero against that of the motor encoder [motor counts].
        disturbance: Of a random force on the axis, first-order [rated force].
        disturbance_time: Correlation time of that force [s].
        viscous: Of the viscous coefficient, relative [1].
    """

    start: float = 0.25
    zero: float = 0.2
    disturbance: float = 8e-4
    disturbance_time: float = 0.012
    viscous: float = 0.02

    def apply(self, p: PlantParameters, seed: int) -> PlantParameters:
        """Return a copy of the parameters with this run's draws in it; the same seed gives the same draws."""
        draw = np.random.default_rng([seed, 0x5CA77E2])
        out = p.copy()
        axis = out.axis
        axis["start_offset"] += self.start * axis["motor_count"] * draw.standard_normal(5)
        axis["load_zero"] += self.zero * axis["motor_count"] * draw.standard_normal(5)
        axis["viscous"] *= 1.0 + self.viscous * draw.standard_normal(5)
        axis["disturbance"] = self.disturbance * 1000.0 * axis["effort_count"]
        axis["disturbance_time"] = self.disturbance_time
        return out
