"""Tool bending: the needle bends across its axis."""

from __future__ import annotations

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class ToolBending(LibraryEffect):
    """Displacement compliance * F across the tool axis, with the slope of a cantilever."""

    id, family, stage = "tool_bending", "compliance", "structure"
    explanation = (
        "A force across the tool bends it: the tip moves across the tool's axis, in proportion, whatever the "
        "pose; a force along the tool does nothing."
    )
    siblings = {"structural_compliance": "a force along the tool moves the tip too"}
    units = {"compliance": "m/N", "slope": "rad/N"}

    def sites(self) -> tuple[str, ...]:
        """The tip."""
        return ("tip",)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen at the loaded tip."""
        return (Channel("structure", "tip"),)

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Two columns: displacement and slope."""
        if view.run.tracker_position is None:
            return Signature()
        axis = view.path.rotation[:, :, 2]
        force = view.path.contact
        across = force - axis * np.einsum("gi,gi->g", axis, force)[:, None]
        columns = np.zeros((len(force), 6, 2))
        columns[:, :3, 0], columns[:, 3:, 1] = across, np.cross(-axis, across)
        return Signature({Channel("structure", "tip"): columns})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Compliance across the tool and slope per force."""
        return {"compliance": float(coefficients[0]), "slope": float(coefficients[1])}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """The tool gives way."""
        return bool(coefficients[0] > 0.0)
