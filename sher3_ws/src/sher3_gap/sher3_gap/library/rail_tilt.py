"""Rail tilt: a rail is not parallel to z of the base."""

from __future__ import annotations

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class RailTilt(LibraryEffect):
    """Rail k leans by two small angles: its slider wanders sideways as it climbs."""

    id, family, stage = "rail_tilt", "geometry", "mechanism"
    explanation = "A rail leans: the tip error grows in proportion to the height of that slider."
    siblings = {"base_tilt": "the whole robot leans", "platform_geometry_error": "does not grow with height"}
    units = {"angle": "rad", "x": "rad", "y": "rad"}

    def sites(self) -> tuple[str, ...]:
        """The rails."""
        return ("delta_1", "delta_2", "delta_3")

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen at the tip."""
        return (Channel("mechanism", "tip"), Channel("structure", "tip"))

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Two columns: leaning along x and along y of the base."""
        change = [view.geometry.pose_change(view.run, 1e-4, **{f"rail_{site[-1]}{a}": 1.0}) for a in "xy"]
        return Signature(view.at_tip(np.stack(change, axis=-1)))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Angle and its components."""
        return {"angle": float(np.hypot(*coefficients)), "x": float(coefficients[0]), "y": float(coefficients[1])}

    def unit(self, name: str, site: str) -> str:
        """Angle."""
        return "rad"
