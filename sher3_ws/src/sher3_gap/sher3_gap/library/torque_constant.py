"""Torque constant: the real force is not the one the drive reports."""

from __future__ import annotations

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column


class TorqueConstant(LibraryEffect):
    """Real force = (1 + relative) * reported effort."""

    id, family, stage = "torque_constant", "scale", "motor_mechanics"
    explanation = "Every force on the axis is off by the same ratio: gravity, acceleration and external load alike."
    siblings = {
        "viscous_friction": "only the part in proportion to speed",
        "payload_mass": "only inertia and weight",
        "gravity_load": "only weight",
    }

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: the force the motion needs. reported - needed = -relative / (1 + relative) * needed."""
        return Signature({Channel(self.stage, site): column(-view.inertial[:, axis_of(site)])})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Force over reported effort, minus one."""
        c = float(coefficients[0])
        return {"relative": c / (1.0 - c)}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Within a factor of three either way."""
        return bool(-2.0 < coefficients[0] < 0.67)
