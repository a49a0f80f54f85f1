"""Link compliance: the links of the delta give way, more at small forces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class LinkCompliance(LibraryEffect):
    """Each link shortens by fraction * spring_factor * a |F|^b: six links carry the load on the platform."""

    id, family, stage = "link_compliance", "compliance", "structure"
    explanation = (
        "The six links of the delta and their joints give way under the load on the tip, relatively more at "
        "small forces than at large ones."
    )
    siblings = {"structural_compliance": "in proportion to the force"}
    units = {"fraction": "1"}

    def sites(self) -> tuple[str, ...]:
        """All links, or those of one leg."""
        return ("tip", "delta_1", "delta_2", "delta_3")

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen at the loaded tip."""
        return (Channel("structure", "tip"),)

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: the deflection of the tip by the paper's law."""
        if view.run.tracker_position is None:
            return Signature()
        legs = (0, 1, 2) if site == "tip" else (int(site[-1]) - 1,)
        out = link_deflection(view, legs)
        return Signature({Channel("structure", "tip"): out[:, :, None]})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Share of the paper's law with pre-loading springs."""
        return {"fraction": float(coefficients[0])}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Links give way."""
        return bool(coefficients[0] > 0.0)


def link_deflection(view: View, legs: Sequence[int]) -> Array:
    """Deflection of the tip (g, 6) from the compliance of the links of `legs` under the known contact force.

    Link forces f = Gamma^-1 w, deflections by the paper's law, tip displaced as by links of other lengths.
    """
    delta = view.robot.delta
    force = view.path.contact
    wrench = np.hstack([force, np.cross(view.lever, force)])
    link = np.linalg.solve(view.links, wrench[:, :, None])[:, :, 0]
    law = delta.link_compliance
    change = delta.spring_factor * law.a * np.sign(link) * np.abs(link) ** law.b
    keep = np.repeat([k in legs for k in range(3)], 2)
    return np.einsum("gij,gj->gi", view.link_changes, change * keep)
