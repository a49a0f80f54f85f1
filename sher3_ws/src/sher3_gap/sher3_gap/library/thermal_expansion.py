"""Thermal expansion: the structure grows with its temperature."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class ThermalExpansion(LibraryEffect):
    """Lengths grow by coefficient * (T - 22 deg C): the links, the arm, the rails, or everything."""

    id, family, stage = "thermal_expansion", "drift", "mechanism"
    explanation = (
        "The tip wanders with the temperature of the structure, in every pose, in proportion to the warming "
        "since 22 deg C."
    )
    siblings = {
        "tool_offset": "does not change with temperature",
        "link_length_error": "does not change with temperature",
    }
    units = {"coefficient": "1/K", "part": "1"}

    def sites(self) -> tuple[str, ...]:
        """The structure."""
        return ("tip",)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen at the tip."""
        return (Channel("mechanism", "tip"), Channel("structure", "tip"))

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """What grows: 0 everything, 1 the links, 2 the arm, 3 the slider travel."""
        if all(np.ptp(v.warmth) == 0.0 and not v.warmth.any() for v in views):
            return []
        return [{"part": float(i)} for i in range(4)]

    def _growth(self, view: View, part: int) -> Array:
        p = view.geometry.parameters
        links = {f"link_{k}": getattr(p, f"link_{k}") for k in (1, 2, 3)}
        arm = {n: getattr(p, n) for n in ("d1", "d2", "d3", "tool_x", "tool_y", "tool_z")}
        if part == 3:
            q = view.geometry.positions(view.run)
            return np.einsum("gik,gk->gi", view.path.jacobian[:, :, [0, 1, 2, 4]], q[:, [0, 1, 2, 4]])
        if part == 0:
            growth = np.zeros((len(view.run.grid), 6))
            growth[:, :3] = view.path.position
            return growth
        return view.geometry.pose_change(view.run, 1e-5, **(links if part == 1 else arm))

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: growth per unit of strain, times the warmth."""
        growth = self._growth(view, int(shape["part"])) * view.warmth[:, None]
        return Signature(view.at_tip(growth[:, :, None]))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Coefficient of expansion and what grows."""
        return {"coefficient": float(coefficients[0]), "part": shape["part"]}
