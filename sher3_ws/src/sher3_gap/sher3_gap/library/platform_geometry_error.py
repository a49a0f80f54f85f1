"""Platform geometry: the joints of a leg, or of all legs, are not where drawn."""

from __future__ import annotations

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class PlatformGeometryError(LibraryEffect):
    """Ball joints of one leg (or all, radially) displaced by x, y in {b}: they shift the leg's anchor."""

    id, family, stage = "platform_geometry_error", "geometry", "mechanism"
    explanation = "The ball joints of the platform or the base are off sideways: the tip error changes smoothly with the position of the platform, not with roll or tilt."
    siblings = {"link_length_error": "along the leg", "rail_tilt": "grows with the height of the slider"}
    units = {"x": "m", "y": "m", "radius": "m"}

    def sites(self) -> tuple[str, ...]:
        """A leg, or the platform as a whole."""
        return ("delta_1", "delta_2", "delta_3", "tip")

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen at the tip."""
        return (Channel("mechanism", "tip"), Channel("structure", "tip"))

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Two columns per leg (x, y of the joint), or one: the radius of all."""
        if site == "tip":
            azimuth = view.robot.delta.leg_azimuth
            grow = {f"anchor_{k + 1}{a}": -f(azimuth[k]) for k in range(3) for a, f in (("x", np.cos), ("y", np.sin))}
            change = view.geometry.pose_change(view.run, 1e-5, **{k: float(v) for k, v in grow.items()})[:, :, None]
        else:
            change = np.stack(
                [view.geometry.pose_change(view.run, 1e-5, **{f"anchor_{site[-1]}{a}": -1.0}) for a in "xy"], axis=-1
            )
        return Signature(view.at_tip(change))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Offsets of the platform's joint."""
        names = ("x", "y") if len(coefficients) == 2 else ("radius",)
        return {n: float(c) for n, c in zip(names, coefficients, strict=True)}

    def unit(self, name: str, site: str) -> str:
        """Length."""
        return "m"
