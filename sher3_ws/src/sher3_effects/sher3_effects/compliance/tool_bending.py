"""Tool bending: the needle bends across its axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.compliance.stiffening import FINER, softness, stiffened
from sher3_effects.page import Page
from sher3_effects.view import AxisView


class ToolBending(Page):
    """Displacement compliance * F across the tool axis, with the slope of a cantilever; it may stiffen."""

    id, family, stage = "tool_bending", "compliance", "structure"
    inputs = ("load", "posture")
    seen_at = (("structure", "tip"),)
    above = 0.0
    best = Best("loads", "known loads in several postures separate springs")
    places = ("tip",)
    gives = ("compliance", "slope", "stiffens")
    explanation = (
        "A force across the tool bends it: the tip moves across the tool's axis, in proportion, whatever the "
        "pose; a force along the tool does nothing."
    )
    siblings = {"structural_compliance": "a force along the tool moves the tip too"}
    units = {"slope": "rad/N", "stiffens": "N"}
    finer = FINER

    def bends(self, views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
        """Return the shape with each force at which the compliance of a tool that stiffens is halved."""
        return stiffened(shape)

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Two columns: displacement and slope."""
        if view.run.tracker_position is None:
            return Signature()
        axis = view.path.rotation[:, :, 2]
        force = view.path.contact
        across = force - axis * np.einsum("gi,gi->g", axis, force)[:, None]
        columns = np.zeros((len(force), 6, 2))
        columns[:, :3, 0], columns[:, 3:, 1] = across, np.cross(-axis, across)
        return Signature({Channel("structure", "tip"): columns * softness(across, shape)})


@dataclass(frozen=True)
class ToolBendingInPlant(PlantEffect, page=ToolBending):
    """The tool is a thin needle: it bends under a force across its axis, not along it."""

    compliance: float = parameter("m/N", 50e-6, 0.0, 5e-3, "displacement of the tip per force across the tool")

    def apply(self, p: PlantParameters) -> None:
        """Soften the tool."""
        p.body["bending"] += self.compliance
        p.body["gives_way"] = True
