"""Link length: one leg of the delta is longer or shorter than drawn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of


class LinkLengthError(LibraryEffect):
    """Links of leg k: link_length + length +- difference."""

    id, family, stage = "link_length_error", "geometry", "mechanism"
    explanation = (
        "One leg of the delta is a little too long or short: the tip is off by an amount that changes "
        "smoothly with the pose."
    )
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

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Both links alike (0), or one longer than the other as well (1), which turns the platform."""
        return [{"apart": 0.0}, {"apart": 1.0}]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Both links of the leg alike, and, apart, one against the other."""
        a, b = 2 * axis_of(site), 2 * axis_of(site) + 1
        both = view.link_changes[:, :, a] + view.link_changes[:, :, b]
        apart = view.link_changes[:, :, a] - view.link_changes[:, :, b]
        return Signature(view.at_tip(np.stack([both, apart] if shape["apart"] else [both], axis=-1)))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Mean length error of the two links and half their difference."""
        return {n: float(c) for n, c in zip(("length", "difference"), coefficients, strict=False)}

    def unit(self, name: str, site: str) -> str:
        """Length."""
        return "m"
