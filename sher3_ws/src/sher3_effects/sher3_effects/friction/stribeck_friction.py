"""Stribeck friction: friction that falls as the axis speeds up."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.friction.bristle import deflection, soften
from sher3_effects.friction.coulomb_friction import CoulombOnAxis
from sher3_effects.friction.dry import DryFriction
from sher3_effects.page import Page
from sher3_effects.view import AxisView

GAUSS, TUSTIN, HESS_SOOM = range(3)
HUMPS: Mapping[int, Callable[[Array], Array]] = {
    GAUSS: lambda x: np.exp(-(x**2)),
    TUSTIN: lambda x: np.exp(-x),
    HESS_SOOM: lambda x: 1.0 / (1.0 + (math.e - 1.0) * x**2),
}
"""Ways to fall with the speed over the Stribeck velocity."""


class StribeckFriction(DryFriction):
    """F = z (force + (static - force) hump(v / stribeck_velocity)): a hump of 1 at rest and 1/e at that velocity.

    It is exp(-x^2) (Bo and Pavelescu 1982), and as a bend exp(-x) (Tustin 1947) or 1 / (1 + (e - 1) x^2) (Hess and Soom
    1990): oils and surfaces differ in how slowly friction falls (Armstrong-Hélouvry, Dupont and Canudas de Wit 1994).
    """

    id, family, stage = "stribeck_friction", "friction", "motor_mechanics"
    inputs = ("direction", "velocity")
    kinds: ClassVar[tuple[str, ...]] = ("robot",)
    dry = True
    settles = True
    slow = True
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

    def bends(self, views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
        """Return humps that fall as Tustin's and as Hess and Soom's."""
        speeds = [shape["stribeck_velocity"] * factor for factor in (0.5, 1.0, 2.0)]
        return [{**shape, "stribeck_velocity": v, "falls": float(law)} for v in speeds for law in (TUSTIN, HESS_SOOM)]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Two columns: the sliding force and the extra one at low speed."""
        axis = view.row(site)
        z = view.sliding(axis, shape["displacement"])
        x = np.abs(view.run.velocity[:, axis]) / shape["stribeck_velocity"]
        hump = z * HUMPS[int(shape.get("falls", GAUSS))](x)
        return Signature({Channel(self.stage, site): column(view.run.to_grid(z), view.run.to_grid(hump))})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return sliding and static force, of coefficients (2,), and the Stribeck velocity."""
        force = float(coefficients[0])
        return {
            "force": force,
            "static": force + float(coefficients[1]),
            "stribeck_velocity": shape["stribeck_velocity"],
        }

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether friction, coefficients (2,), resists and falls with speed, markedly."""
        return bool(coefficients[0] >= 0.0 and coefficients[1] > 0.1 * coefficients[0])


class StribeckOnAxis(StribeckFriction):
    """The same on one axis of any machine: the hump is below its top speed, and not many times the friction."""

    kinds = ("axis",)
    finer = {"stribeck_velocity": (0.7, 0.85, 1.2, 1.4)}
    polished = ("displacement",)
    bends = Page.bends
    bounds = {"force": (0.0, np.inf), "static": (0.0, np.inf), "stribeck_velocity": (0.0, np.inf)}
    SHARES = (0.02, 0.05, 0.1, 0.2)
    """Of the top speed, where the lead is not known."""
    MOST = 0.5
    """Share of the top speed below which the hump lies: beyond it, it is a friction that falls throughout."""
    HIGHEST = 3.0
    """Friction at rest over friction in motion at most: lubricated and plastic pairs stay below it."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return Stribeck velocities below the top speed, each with the displacements of Coulomb friction."""
        axes = [v.axis(site) for v in views]
        top, known = max(a.top for a in axes), axes[0].lead_known
        tried = [s["stribeck_velocity"] for s in super().shapes(views, site)] if known else []
        most = self.MOST * top / max(self.finer["stribeck_velocity"]) ** 2
        found = [v for v in tried or [s * top for s in self.SHARES] if 0.0 < v <= most]
        sliding = CoulombOnAxis().shapes(views, site)
        return [{"stribeck_velocity": v, **shape} for v in found for shape in sliding]

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether friction (2,) resists, falls with speed, and is at rest less than `HIGHEST` times sliding."""
        sliding, more = map(float, coefficients)
        return super().admissible(shape, coefficients) and sliding + more < self.HIGHEST * sliding


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
