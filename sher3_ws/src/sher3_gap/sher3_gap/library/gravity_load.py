"""Gravity load: weight on an axis that differs from the model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column


class GravityLoad(LibraryEffect):
    """Extra gravity force on an axis: in proportion to the modelled one, or constant."""

    id, family, stage = "gravity_load", "inertia", "motor_mechanics"
    explanation = "The axis holds more or less weight than the model says, at rest and in motion, without more inertia."
    siblings = {
        "payload_mass": "inertia as well as weight",
        "torque_constant": "all forces are scaled",
        "cable_drag": "the force changes with pose and direction",
    }
    units = {"relative": "1", "force": "N"}

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Scaled (0) or constant (1)."""
        return [{"constant": 0.0}, {"constant": 1.0}]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: the modelled gravity force, or one."""
        gravity = view.path.gravity[:, axis_of(site)]
        return Signature({Channel(self.stage, site): column(np.ones_like(gravity) if shape["constant"] else gravity)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Ratio of the extra weight to the modelled one, or the extra force."""
        return {"force" if shape["constant"] else "relative": float(coefficients[0])}
