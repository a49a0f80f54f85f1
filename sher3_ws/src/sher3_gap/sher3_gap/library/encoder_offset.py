"""Encoder offset: an axis was homed wrongly."""

from __future__ import annotations

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of


class EncoderOffset(LibraryEffect):
    """Both encoders of the axis read q + offset."""

    id, family, stage = "encoder_offset", "geometry", "mechanism"
    explanation = (
        "Both encoders of an axis are off by the same constant: only the tip shows it, along that axis' "
        "direction of motion."
    )
    siblings = {
        "tool_offset": "constant in the tool frame",
        "link_length_error": "along the leg instead of along the rail",
    }
    units = {"offset": "m"}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen at the tip."""
        return (Channel("mechanism", "tip"), Channel("structure", "tip"))

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: minus the axis' Jacobian column."""
        return Signature(view.at_tip(-view.path.jacobian[:, :, [axis_of(site)]]))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Offset of the readings."""
        return {"offset": float(coefficients[0])}
