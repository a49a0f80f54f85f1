"""Friction of an axis: one bristle, whose sliding level the effects raise.

F = g(v, q, t) z / displacement with z' = v - |v| z / displacement: elastic before it slides, g in sliding, no damping
(Dahl 1968; LuGre, Canudas de Wit 1995). Levels add up; of several deflections the largest counts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from sher3_sim.effects.base import Effect, parameter
from sher3_sim.parameters import PlantParameters

SHORT = 2e-6
"""Deflection [m] at which friction slides where the effect does not say."""


def _deflection(default: float = SHORT) -> Any:
    return parameter("m", default, 1e-8, 1e-3, "deflection before sliding")


def _soften(p: PlantParameters, rows: list[int], displacement: float) -> None:
    p.axis["displacement"][rows] = np.maximum(p.axis["displacement"][rows], displacement)


@dataclass(frozen=True)
class CoulombFriction(Effect, id="coulomb_friction", family="friction", stage="motor_mechanics"):
    """A constant force against motion; at rest it holds up to that force, over a few micrometres of deflection."""

    force: float = parameter("N", 1.0, 0.0, 50.0, "friction in sliding")
    displacement: float = _deflection()

    def apply(self, p: PlantParameters) -> None:
        """Raise the sliding and static level alike."""
        p.axis["coulomb"][self.rows] += self.force
        p.axis["static"][self.rows] += self.force
        _soften(p, self.rows, self.displacement)


@dataclass(frozen=True)
class StribeckFriction(Effect, id="stribeck_friction", family="friction", stage="motor_mechanics"):
    """Friction that is higher near standstill and falls as the lubricant film builds up: stick-slip."""

    force: float = parameter("N", 1.0, 0.0, 50.0, "friction in fast sliding")
    static: float = parameter("N", 1.5, 0.0, 100.0, "friction near standstill")
    stribeck_velocity: float = parameter("m/s", 1e-3, 1e-6, 1.0, "where the hump has fallen to 1/e")
    displacement: float = _deflection()

    def apply(self, p: PlantParameters) -> None:
        """Raise both levels and set the velocity between them."""
        p.axis["coulomb"][self.rows] += self.force
        p.axis["static"][self.rows] += max(self.static, self.force)
        p.axis["stribeck_velocity"][self.rows] = self.stribeck_velocity
        _soften(p, self.rows, self.displacement)


@dataclass(frozen=True)
class ViscousFriction(Effect, id="viscous_friction", family="friction", stage="motor_mechanics"):
    """Friction in proportion to speed beyond the nominal one: lubricant, seals, back-EMF."""

    extra: float = parameter("N s/m", 60.0, -60.0, 2000.0, "added to the nominal viscous coefficient")

    def apply(self, p: PlantParameters) -> None:
        """Add damping."""
        p.axis["viscous"][self.rows] += self.extra


@dataclass(frozen=True)
class PreslidingFriction(Effect, id="presliding_friction", family="friction", stage="motor_mechanics"):
    """Friction that yields over tens of micrometres before it slides: rolling contacts, wipers."""

    force: float = parameter("N", 1.0, 0.0, 50.0, "friction in sliding")
    displacement: float = _deflection(20e-6)

    def apply(self, p: PlantParameters) -> None:
        """Raise the level and soften the bristle."""
        p.axis["coulomb"][self.rows] += self.force
        p.axis["static"][self.rows] += self.force
        _soften(p, self.rows, self.displacement)


@dataclass(frozen=True)
class PositionFriction(Effect, id="position_friction", family="friction", stage="motor_mechanics"):
    """Friction that changes along the travel, against motion in both directions: preload, guide, seal."""

    force: float = parameter("N", 1.0, 0.0, 50.0, "mean friction in sliding")
    amplitude: float = parameter("N", 0.5, 0.0, 50.0, "of its change along the travel")
    periods_per_rev: float = parameter("1", 1.0, 0.01, 200.0, "periods per lead")
    phase: float = parameter("rad", 0.0, -7.0, 7.0, "of the change at zero position", fixed_unit=True)
    displacement: float = _deflection()

    def apply(self, p: PlantParameters) -> None:
        """Raise the level and modulate it."""
        p.axis["coulomb"][self.rows] += self.force
        p.axis["static"][self.rows] += self.force
        p.axis["friction_amplitude"][self.rows] = self.amplitude
        p.axis["friction_periods"][self.rows] = self.periods_per_rev
        p.axis["friction_phase"][self.rows] = self.phase
        _soften(p, self.rows, self.displacement)


@dataclass(frozen=True)
class FrictionDrift(Effect, id="friction_drift", family="friction", stage="motor_mechanics"):
    """Extra friction at the start of a run that runs in: force exp(-t / time_constant)."""

    force: float = parameter("N", 1.0, 0.0, 50.0, "extra friction at the start of the run")
    time_constant: float = parameter("s", 2.0, 0.05, 3600.0, "of its decay")
    displacement: float = _deflection()

    def apply(self, p: PlantParameters) -> None:
        """Add the decaying level."""
        p.axis["friction_decaying"][self.rows] += self.force
        p.axis["friction_decay_time"][self.rows] = self.time_constant
        _soften(p, self.rows, self.displacement)
