"""Lead error: a constant ratio between motor and load."""

from __future__ import annotations

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column


class LeadError(LibraryEffect):
    """load = (1 + relative) * motor."""

    id, family, stage = "lead_error", "scale", "transmission"
    explanation = (
        "The load moves a little more or less than the motor, in proportion to the travel; the load encoder "
        "and the tip agree."
    )
    siblings = {
        "encoder_scale": "the tip does not follow the load encoder",
        "thermal_expansion": "grows with temperature",
    }

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: the motor position."""
        return Signature({Channel(self.stage, site): column(view.position[:, axis_of(site)])})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Ratio error."""
        return {"relative": float(coefficients[0])}
