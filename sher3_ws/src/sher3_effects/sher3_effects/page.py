"""What a page says beside the engine's data sheet: how its parameters enter the simulators."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, NamedTuple

from sher3_description import Robot
from sher3_diagnosis.effect import ROTARY, Effect
from sher3_sim.effect import Parameter, PlantEffect

Values = Mapping[str, float]
"""Fitted parameters by name, SI units."""


class Part(NamedTuple):
    """One effect of the plant: its id, where it sits, and its parameters by the plant's names."""

    effect: str
    actuator: str
    parameters: dict[str, float]


class Page(Effect):
    """One effect in a file of its own.

    Class attributes:
        plant: its form in the plant, which states unit, default and bounds of every parameter the plant takes; set by
            that form. None where the plant has none.
        breaks: which relation of the signal chain the effect breaks, where that is not the one named like its stage:
            "load_encoder", "both_encoders" or "force_sensor", the readings.
        on_axis: fitted parameter -> constant of the equation of motion of a simulated axis, which it sets. The
            constants are `coulomb`, `static` and `offset` (N or N m), `stribeck` (m/s or rad/s), `viscous` (N/(m/s) or
            N m/(rad/s)), `weight` and `drive` (relative change of the weight and of the drive's force).
    """

    plant: ClassVar[type[PlantEffect] | None] = None
    breaks: ClassVar[str] = ""
    on_axis: ClassVar[Mapping[str, str]] = {}

    def to_simulator(self, actuator: str, values: Values, robot: Robot) -> list[Part]:
        """Return the effects of the plant that a fitted cause stands for; default this one with the same parameters.

        Args:
            actuator: site of the cause.
            values: its fitted parameters.
            robot: nominal model.
        """
        return [Part(self.id, actuator, dict(values))]

    @property
    def specification(self) -> Mapping[str, Parameter]:
        """The plant's parameters with their units and bounds on a linear axis."""
        return self.plant.specification(self.plant.sites[0]) if self.plant else {}

    def unit(self, name: str, site: str, rotary: bool) -> str:
        """Return the unit of a fitted parameter; of one that the page does not state, the plant's."""
        if name not in self.units and name in self.specification:
            found = self.specification[name]
            return ROTARY.get(found.unit, found.unit) if rotary and not found.fixed_unit else found.unit
        return super().unit(name, site, rotary)
