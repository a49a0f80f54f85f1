"""Presliding friction: an elastic-plastic force over tens to hundreds of micrometres."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column, lead


class PreslidingFriction(LibraryEffect):
    """F = force * z, z the Dahl state over a displacement that is long against the encoder."""

    id, family, stage = "presliding_friction", "friction", "motor_mechanics"
    explanation = (
        "After a reversal the friction force builds up gradually, over a micrometre-scale stroke, as bristles "
        "bend before they "
        "slip: force-displacement loops whose width grows with the stroke."
    )
    siblings = {
        "coulomb_friction": "the force reverses at once",
        "cable_drag": "the force grows with the distance from one pose and does not saturate",
    }
    units = {"force": "N", "displacement": "m"}
    DISPLACEMENTS = (0.01, 0.02, 0.04, 0.08, 0.16, 0.32)
    """In motor revolutions: 20 um to 0.64 mm on a 2 mm lead."""

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Displacement over which the force builds up."""
        return [{"displacement": d * lead(views[0], site)} for d in self.DISPLACEMENTS]

    def refine(self, shape: Shape) -> list[Shape]:
        """Between the neighbours."""
        return [{"displacement": shape["displacement"] * f} for f in (0.7, 0.85, 1.2, 1.4)]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: the Dahl state."""
        z = view.run.to_grid(view.sliding(axis_of(site), shape["displacement"]))
        return Signature({Channel(self.stage, site): column(z)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Force, displacement and the initial stiffness they give."""
        force = float(coefficients[0])
        return {"force": force, "displacement": shape["displacement"], "stiffness": force / shape["displacement"]}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Friction resists."""
        return bool(coefficients[0] > 0.0)
