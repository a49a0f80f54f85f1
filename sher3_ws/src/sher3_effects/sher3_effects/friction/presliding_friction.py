"""Presliding friction: an elastic-plastic force over tens to hundreds of micrometres."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Best, Shape
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.friction.bristle import deflection, rub
from sher3_effects.friction.dry import DryFriction
from sher3_effects.view import AxisView


class PreslidingFriction(DryFriction):
    """F = force * z, z the Dahl state over a displacement that is long against the encoder."""

    id, family, stage = "presliding_friction", "friction", "motor_mechanics"
    inputs = ("direction",)
    above = 0.0
    kinds: ClassVar[tuple[str, ...]] = ("robot",)
    on_axis = {"force": "coulomb"}
    dry = True
    slow = True
    best = Best("reversals", "reversals of several amplitudes and speeds separate friction laws")
    leaves_out = "how its level varies over the stroke"
    explanation = (
        "After a reversal the friction force builds up gradually, over a micrometre-scale stroke, as bristles "
        "bend before they "
        "slip: force-displacement loops whose width grows with the stroke."
    )
    siblings = {
        "coulomb_friction": "the force reverses at once",
        "cable_drag": "the force grows with the distance from one pose and does not saturate",
    }
    DISPLACEMENTS = (0.01, 0.02, 0.04, 0.08, 0.16, 0.32)
    """In motor revolutions: 20 um to 0.64 mm on a 2 mm lead."""
    units: ClassVar[Mapping[str, str]] = {"stiffness": "N/m"}
    finer = {"displacement": (0.7, 0.85, 1.2, 1.4)}

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the force (1,), the displacement and the initial stiffness they give."""
        force = float(coefficients[0])
        return {"force": force, "displacement": shape["displacement"], "stiffness": force / shape["displacement"]}


class PreslidingOnAxis(PreslidingFriction):
    """The same on one axis of any machine: bristles bend over a small part of its travel, never over degrees."""

    kinds = ("axis",)
    extends = ("coulomb_friction",)
    extends_by = ("displacement",)
    bounds = {"displacement": (0.0, np.inf), "force": (0.0, np.inf), "stiffness": (0.0, np.inf)}
    SHARES = (0.001, 0.002, 0.004, 0.008, 0.016, 0.03)
    """Of the travel, where the lead is not known."""
    MOST = 0.05
    """Share of the travel over which friction may build up; beyond it the force is one of the position."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return displacements that stay a small part of the travel after the finer search, too."""
        axes = [v.axis(site) for v in views]
        travel, lead = max(a.travel for a in axes), axes[0].lead
        tried = [d * lead for d in self.DISPLACEMENTS] if axes[0].lead_known else [s * travel for s in self.SHARES]
        most = self.MOST * travel / max(self.finer["displacement"]) ** 2
        return [{"displacement": d} for d in tried if 0.0 < d <= most]


@dataclass(frozen=True)
class PreslidingFrictionInPlant(PlantEffect, page=PreslidingFriction):
    """Friction that yields over tens of micrometres before it slides: rolling contacts, wipers."""

    force: float = parameter("N", 1.0, 0.0, 50.0, "friction in sliding")
    displacement: float = deflection(20e-6)

    def apply(self, p: PlantParameters) -> None:
        """Raise the level and soften the bristle."""
        rub(p, self.rows, self.force, self.displacement)
