"""Platform geometry: the joints of a leg, or of all legs, are not where drawn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of


class PlatformGeometryError(LibraryEffect):
    """Ball joints of one leg (or all, radially) displaced by x, y in {b}: they shift the leg's anchor."""

    id, family, stage = "platform_geometry_error", "geometry", "mechanism"
    explanation = (
        "The ball joints of the platform or the base are off sideways: the tip error changes smoothly with "
        "the position of the platform, not with roll or tilt."
    )
    siblings = {"link_length_error": "along the leg", "rail_tilt": "grows with the height of the slider"}
    units = {"x": "m", "y": "m", "difference": "m", "radius": "m"}

    def sites(self) -> tuple[str, ...]:
        """A leg, or the platform as a whole."""
        return ("delta_1", "delta_2", "delta_3", "tip")

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen at the tip."""
        return (Channel("mechanism", "tip"), Channel("structure", "tip"))

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Which of the leg's two balls: both (0), the first (1), the second (2), both but not quite alike (3)."""
        return [{"ball": 0.0}] if site == "tip" else [{"ball": float(b)} for b in range(4)]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Two columns (x, y of the balls) per leg, a third for how the two differ along it, or one: the radius of all.

        A ball displaced by d changes what its link spans by u . d, u the link's direction.
        """
        azimuth = view.robot.delta.leg_azimuth
        span = view.links[:, :3]
        if site == "tip":
            outward = np.repeat([[np.cos(a), np.sin(a), 0.0] for a in azimuth], 2, axis=0)
            change = np.einsum("gij,gkj,jk->gi", view.link_changes, span, outward)[:, :, None]
        else:
            first = 2 * axis_of(site)
            links = {1: (first,), 2: (first + 1,)}.get(int(shape["ball"]), (first, first + 1))
            change = sum(view.link_changes[:, :, [j]] * span[:, None, :2, j] for j in links)
            if shape["ball"] == 3.0:
                apart = view.link_changes[:, :, [first]] - view.link_changes[:, :, [first + 1]]
                change = np.concatenate([change, apart], axis=2)
        return Signature(view.at_tip(-change))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Offsets of the platform's joint."""
        names = ("radius",) if len(coefficients) == 1 else ("x", "y", "difference")
        return {n: float(c) for n, c in zip(names, coefficients, strict=False)}

    def unit(self, name: str, site: str) -> str:
        """Length."""
        return "m"
