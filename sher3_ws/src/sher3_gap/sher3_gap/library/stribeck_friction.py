"""Stribeck friction: friction that falls as the axis speeds up."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column, lead


class StribeckFriction(LibraryEffect):
    """F = z (force + (static - force) exp(-(v / stribeck_velocity)^2))."""

    id, family, stage = "stribeck_friction", "friction", "motor_mechanics"
    extends = ("coulomb_friction",)
    explanation = (
        "Friction is higher when the axis starts or creeps than when it runs: a hump of extra force at low "
        "speed, and a tendency to stick and slip."
    )
    siblings = {"coulomb_friction": "the same force at every speed", "viscous_friction": "the force grows with speed"}
    units = {"force": "N", "static": "N", "stribeck_velocity": "m/s"}
    VELOCITIES = (0.1, 0.2, 0.4, 0.8, 1.6)
    """In motor revolutions per second: 0.2 to 3.2 mm/s on a 2 mm lead."""

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Stribeck velocity; the displacement is that of Coulomb friction."""
        scale = lead(views[0], site)
        return [{"stribeck_velocity": v * scale, "displacement": 2.5e-3 * scale} for v in self.VELOCITIES]

    def refine(self, shape: Shape) -> list[Shape]:
        """Between the neighbours, and a shorter displacement."""
        out: list[Shape] = [
            {**shape, "stribeck_velocity": shape["stribeck_velocity"] * f} for f in (0.7, 0.85, 1.2, 1.4)
        ]
        return [*out, {**shape, "displacement": shape["displacement"] * 0.4}]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Two columns: the sliding force and the extra one at low speed."""
        axis = axis_of(site)
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
