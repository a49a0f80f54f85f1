"""What follows the temperature, relative to 22 degC."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sher3_description import ACTUATORS

from sher3_sim.effects.base import Effect, parameter
from sher3_sim.parameters import PlantParameters


@dataclass(frozen=True)
class ThermalExpansion(
    Effect, id="thermal_expansion", family="drift", stage="mechanism", places=(*ACTUATORS[:3], "tilt", "tip", "all")
):
    """The structure grows with its temperature: one slide, the whole robot from its base, or a part of it."""

    coefficient: float = parameter("1/K", 12e-6, -1e-3, 1e-3, "relative growth per kelvin")
    part: float = parameter("1", 0.0, 0.0, 3.0, "what grows: 0 everything, 1 the links, 2 the arm, 3 all slides")

    def apply(self, p: PlantParameters) -> None:
        """Grow one slide, or a part of the robot."""
        if self.actuator in ACTUATORS:
            p.axis["expansion"][self.rows] += self.coefficient
        elif round(self.part) == 3:
            p.axis["expansion"][[0, 1, 2, 4]] += self.coefficient
        else:
            p.body[("expansion", "link_expansion", "arm_expansion")[round(self.part)]] += self.coefficient


def _drift(axis: str, default: float) -> Any:
    return parameter("N/K", default, -5.0, 5.0, f"drift of the reading along {axis} of {{f}}")


@dataclass(frozen=True)
class ForceDrift(Effect, id="force_drift", family="drift", stage="sensing", places=("force_sensor",)):
    """The force sensor's zero follows the temperature."""

    fx: float = _drift("x", 0.0)
    fy: float = _drift("y", 0.0)
    fz: float = _drift("z", 0.02)

    def apply(self, p: PlantParameters) -> None:
        """Add the drift."""
        p.body["wrench_drift"][0, :3] += (self.fx, self.fy, self.fz)
