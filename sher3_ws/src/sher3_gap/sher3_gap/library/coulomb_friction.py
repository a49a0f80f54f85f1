"""Coulomb friction: a force of constant size against the motion."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column, lead


class CoulombFriction(LibraryEffect):
    """F = force * z, z the Dahl state over a displacement of a few micrometres."""

    id, family, stage = "coulomb_friction", "friction", "motor_mechanics"
    explanation = (
        "The axis needs a constant extra force whose sign follows the direction of motion: a step at every "
        "reversal, the same "
        "at every speed."
    )
    siblings = {
        "presliding_friction": "the force builds up over tens of micrometres instead of a few",
        "stribeck_friction": "the force is higher at low speed",
        "viscous_friction": "the force grows with speed",
    }
    units = {"force": "N", "displacement": "m"}
    DISPLACEMENTS = (1.0e-3, 2.5e-3, 5.0e-3)
    """In motor revolutions: 2, 5 and 10 um on a 2 mm lead."""

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Displacement over which the force reverses."""
        return [{"displacement": d * lead(views[0], site)} for d in self.DISPLACEMENTS]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: the Dahl state."""
        z = view.run.to_grid(view.sliding(axis_of(site), shape["displacement"]))
        return Signature({Channel(self.stage, site): column(z)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Force and displacement."""
        return {"force": float(coefficients[0]), "displacement": shape["displacement"]}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Friction resists."""
        return bool(coefficients[0] > 0.0)
