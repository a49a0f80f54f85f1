"""Transmission compliance: the load gives way in proportion to the force."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column


class TransmissionCompliance(LibraryEffect):
    """load = motor - force / stiffness, force what the load side needs."""

    id, family, stage = "transmission_compliance", "compliance", "transmission"
    explanation = (
        "Between motor and load lies a spring: their difference follows weight, external load and acceleration."
    )
    siblings = {
        "backlash": "a fixed width, whatever the force",
        "transmission_hysteresis": "follows the path, not the force",
    }
    units = {"stiffness": "N/m", "compliance": "m/N"}

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Share of the axis' mass on the load side of the spring."""
        return [{"load_mass": s} for s in (0.0, 0.1, 0.3, 1.0)]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: minus the force on the spring."""
        axis = axis_of(site)
        static = view.path.gravity[:, axis] - view.path.contact_force[:, axis]
        moving = view.run.to_grid(view.run.acceleration[:, axis]) * view.robot.actuators[axis].mass
        return Signature({Channel(self.stage, site): column(-(static + shape["load_mass"] * moving))})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Stiffness and its inverse."""
        c = float(coefficients[0])
        return {"stiffness": 1.0 / c if c else 0.0, "compliance": c}

    def unit(self, name: str, site: str) -> str:
        """Angles and moments on roll."""
        unit = {"stiffness": "N/m", "compliance": "m/N"}[name]
        return {"N/m": "N*m/rad", "m/N": "rad/(N*m)"}[unit] if site == "roll" else unit

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """A spring."""
        return bool(coefficients[0] > 0.0)
