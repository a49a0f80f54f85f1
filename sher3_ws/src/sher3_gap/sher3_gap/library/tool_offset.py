"""Tool offset: the tip is not where the tool drawing says."""

from __future__ import annotations

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class ToolOffset(LibraryEffect):
    """The tip in {a} is off by x, y, z: a constant in the tool frame."""

    id, family, stage = "tool_offset", "geometry", "mechanism"
    explanation = (
        "The needle is bent or seated differently: the tip error is constant in the tool's own frame and "
        "turns with roll and tilt."
    )
    siblings = {
        "encoder_offset": "constant in one joint",
        "base_tilt": "constant in the base, the orientation is off too",
    }
    units = {"x": "m", "y": "m", "z": "m"}

    def sites(self) -> tuple[str, ...]:
        """The tip."""
        return ("tip",)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen at the tip."""
        return (Channel("mechanism", "tip"), Channel("structure", "tip"))

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Three columns: the axes of the tool frame."""
        columns = np.zeros((len(view.run.grid), 6, 3))
        columns[:, :3] = view.path.rotation
        return Signature(view.at_tip(columns))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Offset in the tool frame."""
        return {n: float(c) for n, c in zip("xyz", coefficients, strict=True)}
