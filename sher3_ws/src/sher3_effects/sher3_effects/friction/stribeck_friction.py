"""Stribeck friction: friction that falls as the axis speeds up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.friction.bristle import deflection, soften
from sher3_effects.page import Page
from sher3_effects.view import AxisView


class StribeckFriction(Page):
    """F = z (force + (static - force) exp(-(v / stribeck_velocity)^2))."""

    id, family, stage = "stribeck_friction", "friction", "motor_mechanics"
    inputs = ("direction", "velocity")
    kinds = ("robot", "axis")
    dry = True
    best = Best("reversals", "reversals of several amplitudes and speeds separate friction laws")
    leaves_out = "how its level varies over the stroke"
    extends = ("coulomb_friction",)
    explanation = (
        "Friction is higher when the axis starts or creeps than when it runs: a hump of extra force at low "
        "speed, and a tendency to stick and slip."
    )
    siblings = {"coulomb_friction": "the same force at every speed", "viscous_friction": "the force grows with speed"}
    on_axis = {"force": "coulomb", "static": "static", "stribeck_velocity": "stribeck"}
    VELOCITIES = (0.1, 0.2, 0.4, 0.8, 1.6)
    """In motor revolutions per second: 0.2 to 3.2 mm/s on a 2 mm lead."""
    finer = {"stribeck_velocity": (0.7, 0.85, 1.2, 1.4), "displacement": (0.4,)}

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Stribeck velocity; the displacement is that of Coulomb friction."""
        scale = views[0].lead(site)
        return [{"stribeck_velocity": v * scale, "displacement": 2.5e-3 * scale} for v in self.VELOCITIES]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Two columns: the sliding force and the extra one at low speed."""
        axis = view.row(site)
        z = view.sliding(axis, shape["displacement"])
        hump = z * np.exp(-((view.run.velocity[:, axis] / shape["stribeck_velocity"]) ** 2))
        return Signature({Channel(self.stage, site): column(view.run.to_grid(z), view.run.to_grid(hump))})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Sliding and static force and the Stribeck velocity."""
        force = float(coefficients[0])
        return {
            "force": force,
            "static": force + float(coefficients[1]),
            "stribeck_velocity": shape["stribeck_velocity"],
        }

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Friction resists and falls with speed, markedly."""
        return bool(coefficients[0] >= 0.0 and coefficients[1] > 0.1 * coefficients[0])


@dataclass(frozen=True)
class StribeckFrictionInPlant(PlantEffect, page=StribeckFriction):
    """Friction that is higher near standstill and falls as the lubricant film builds up: stick-slip."""

    force: float = parameter("N", 1.0, 0.0, 50.0, "friction in fast sliding")
    static: float = parameter("N", 1.5, 0.0, 100.0, "friction near standstill")
    stribeck_velocity: float = parameter("m/s", 1e-3, 1e-6, 1.0, "where the hump has fallen to 1/e")
    displacement: float = deflection()

    def apply(self, p: PlantParameters) -> None:
        """Raise both levels and set the velocity between them."""
        p.axis["coulomb"][self.rows] += self.force
        p.axis["static"][self.rows] += max(self.static, self.force)
        p.axis["stribeck_velocity"][self.rows] = self.stribeck_velocity
        soften(p, self.rows, self.displacement)
