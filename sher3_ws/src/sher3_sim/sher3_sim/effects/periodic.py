"""Errors with a period of the motor's revolution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sher3_sim.effects.base import Effect, parameter
from sher3_sim.parameters import PlantParameters


def _phase() -> Any:
    return parameter("rad", 0.0, -7.0, 7.0, "at zero position", fixed_unit=True)


@dataclass(frozen=True)
class Cogging(Effect, id="cogging", family="periodic", stage="motor_mechanics"):
    """Magnets pull the rotor towards the teeth: a force that repeats with the motor's angle, alike both ways."""

    amplitude: float = parameter("N", 0.5, 0.0, 50.0, "of the force")
    periods_per_rev: float = parameter("1", 12.0, 0.5, 200.0, "periods per lead")
    phase: float = _phase()

    def apply(self, p: PlantParameters) -> None:
        """Add the force."""
        p.axis["cogging_amplitude"][self.rows] = self.amplitude
        p.axis["cogging_periods"][self.rows] = self.periods_per_rev
        p.axis["cogging_phase"][self.rows] = self.phase


@dataclass(frozen=True)
class TransmissionRipple(Effect, id="transmission_ripple", family="periodic", stage="transmission"):
    """The load runs ahead and behind within a revolution: screw drunkenness, kinematic error of the harmonic drive."""

    amplitude: float = parameter("m", 3e-6, 0.0, 1e-3, "of the load's motion")
    periods_per_rev: float = parameter("1", 1.0, 0.5, 200.0, "periods per lead")
    phase: float = _phase()
    base_amplitude: float = parameter("m", 0.0, 0.0, 1e-3, "of a companion with one period per lead")
    base_phase: float = _phase()

    def apply(self, p: PlantParameters) -> None:
        """Add the motion."""
        p.axis["ripple_amplitude"][self.rows] = self.amplitude
        p.axis["ripple_periods"][self.rows] = self.periods_per_rev
        p.axis["ripple_phase"][self.rows] = self.phase
        p.axis["ripple_base_amplitude"][self.rows] = self.base_amplitude
        p.axis["ripple_base_phase"][self.rows] = self.base_phase


@dataclass(frozen=True)
class EncoderEccentricity(Effect, id="encoder_eccentricity", family="periodic", stage="sensing"):
    """The load encoder's code is off centre and reads ahead and behind once per lead; the load itself does not move."""

    amplitude: float = parameter("m", 3e-6, 0.0, 1e-3, "of the reading")
    phase: float = _phase()

    def apply(self, p: PlantParameters) -> None:
        """Add the reading error."""
        p.axis["eccentricity"][self.rows] = self.amplitude
        p.axis["eccentricity_phase"][self.rows] = self.phase
