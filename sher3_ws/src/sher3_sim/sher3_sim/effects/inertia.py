"""Masses the model does not know."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_sim.effects.base import AXES, Effect, parameter
from sher3_sim.parameters import PlantParameters


def carried_mass(p: PlantParameters, row: int) -> float:
    """Return the nominal mass [kg] whose weight an axis carries."""
    arm = p.robot.arm
    return (p.robot.delta.moving_mass if row < 3 else arm.tilt_mass + (arm.roll_mass if row == 3 else 0.0)) or 1.0


@dataclass(frozen=True)
class PayloadMass(Effect, id="payload_mass", family="inertia", stage="motor_mechanics", places=(*AXES, "all")):
    """More mass to accelerate on an axis than the model has; on a slider, whose rail is vertical, also more weight."""

    mass: float = parameter("kg", 0.5, -5.0, 20.0, "added to the axis")

    def apply(self, p: PlantParameters) -> None:
        """Add inertia, and on the sliders the weight of the same mass on the platform."""
        for row in self.rows:
            p.axis["mass"][row] += self.mass if row != 3 or self.actuator == "roll" else self.mass / 500
            if row < 3:
                p.axis["gravity_scale"][row] += self.mass / carried_mass(p, row)


@dataclass(frozen=True)
class GravityLoad(Effect, id="gravity_load", family="inertia", stage="motor_mechanics", places=(*AXES, "all")):
    """More weight on an axis than the model has, without inertia worth speaking of: a wrong mass, a lost spring."""

    mass: float = parameter(
        "kg", 0.2, -2.0, 10.0, "whose weight is added where the axis carries its own", fixed_unit=True
    )

    def apply(self, p: PlantParameters) -> None:
        """Scale the axis's own gravity."""
        for row in self.rows:
            p.axis["gravity_scale"][row] += self.mass / carried_mass(p, row)
