"""Viscous friction: a force in proportion to speed."""

from __future__ import annotations

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column


class ViscousFriction(LibraryEffect):
    """F = extra * v."""

    id, family, stage = "viscous_friction", "friction", "motor_mechanics"
    explanation = (
        "The axis needs more force the faster it moves, in proportion: lubricant or seals are stiffer than "
        "the model says."
    )
    siblings = {
        "coulomb_friction": "the force does not depend on speed",
        "torque_constant": "all forces are scaled, gravity too",
    }
    units = {"extra": "N/(m/s)"}

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: the motor velocity."""
        return Signature({Channel(self.stage, site): column(view.velocity[:, axis_of(site)])})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Coefficient over the nominal one."""
        return {"extra": float(coefficients[0])}
