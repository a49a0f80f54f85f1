"""Base tilt: the whole robot leans against the frame of measurement."""

from __future__ import annotations

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class BaseTilt(LibraryEffect):
    """{b} is rotated by two small angles about x and y."""

    id, family, stage = "base_tilt", "geometry", "mechanism"
    explanation = (
        "The base leans: position and orientation of the tip are rotated about the origin of the base, the "
        "same in every pose."
    )
    siblings = {"rail_tilt": "one rail only, the orientation stays", "tool_offset": "turns with the tool"}
    units = {"angle": "rad", "x": "rad", "y": "rad"}

    def sites(self) -> tuple[str, ...]:
        """The whole mechanism."""
        return ("tip",)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen at the tip."""
        return (Channel("mechanism", "tip"), Channel("structure", "tip"))

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Two columns: about x and about y."""
        change = [view.geometry.pose_change(view.run, 1e-4, **{f"base_{a}": 1.0}) for a in "xy"]
        return Signature(view.at_tip(np.stack(change, axis=-1)))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Angle and its components."""
        return {"angle": float(np.hypot(*coefficients)), "x": float(coefficients[0]), "y": float(coefficients[1])}

    def unit(self, name: str, site: str) -> str:
        """Angle."""
        return "rad"
