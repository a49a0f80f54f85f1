"""Link length: one leg of the delta is longer or shorter than drawn."""

from __future__ import annotations

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class LinkLengthError(LibraryEffect):
    """L_k = link_length + length."""

    id, family, stage = "link_length_error", "geometry", "mechanism"
    explanation = "One leg of the delta is a little too long or short: the tip is off by an amount that changes smoothly with the pose."
    siblings = {
        "encoder_offset": "the leg's slider is off along its rail",
        "platform_geometry_error": "a joint of the leg is off sideways",
        "tool_offset": "turns with the tool",
    }
    units = {"length": "m"}

    def sites(self) -> tuple[str, ...]:
        """The legs."""
        return ("delta_1", "delta_2", "delta_3")

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen at the tip."""
        return (Channel("mechanism", "tip"), Channel("structure", "tip"))

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: the change of the pose per metre."""
        change = view.geometry.pose_change(view.run, 1e-5, **{f"link_{site[-1]}": 1.0})
        return Signature(view.at_tip(change[:, :, None]))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Length error."""
        return {"length": float(coefficients[0])}

    def unit(self, name: str, site: str) -> str:
        """Length."""
        return "m"
