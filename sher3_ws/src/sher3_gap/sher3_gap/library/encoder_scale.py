"""Encoder scale: a constant ratio between the load and its encoder."""

from __future__ import annotations

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column


class EncoderScale(LibraryEffect):
    """reading = (1 + relative) * load."""

    id, family, stage = "encoder_scale", "scale", "sensing"
    explanation = (
        "The load encoder reads a little too much or too little, in proportion to the travel; the tip shows "
        "that the load is where the motor says."
    )
    siblings = {"lead_error": "the tip follows the load encoder"}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen against the motor encoder."""
        return (Channel("transmission", site),)

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """The position, and at the tip the motion that did not happen."""
        axis = axis_of(site)
        q = view.position[:, axis]
        tip = -view.path.jacobian[:, :, [axis]] * q[:, None, None]
        return Signature({Channel("transmission", site): column(q), **view.at_tip(tip)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Ratio error."""
        return {"relative": float(coefficients[0])}
