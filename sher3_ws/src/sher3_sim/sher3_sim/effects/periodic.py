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
    """Magnets pull the rotor towards the teeth: a force with a period of the motor's angle, the same in both directions."""

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

    def apply(self, p: PlantParameters) -> None:
        """Add the motion."""
        p.axis["ripple_amplitude"][self.rows] = self.amplitude
        p.axis["ripple_periods"][self.rows] = self.periods_per_rev
        p.axis["ripple_phase"][self.rows] = self.phase


@dataclass(frozen=True)
class EncoderEccentricity(Effect, id="encoder_eccentricity", family="periodic", stage="sensing"):
    """The load encoder's code is off centre and reads ahead and behind once per lead; the load itself does not move."""

    amplitude: float = parameter("m", 3e-6, 0.0, 1e-3, "of the reading")
    phase: float = _phase()

    def apply(self, p: PlantParameters) -> None:
        """Add the reading error."""
        p.axis["eccentricity"][self.rows] = self.amplitude
        p.axis["eccentricity_phase"][self.rows] = self.phase
