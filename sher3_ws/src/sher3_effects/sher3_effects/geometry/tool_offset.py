"""Tool offset: the tip is not where the tool drawing says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import Robot
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect
from sher3_sim.parameters import PlantParameters

from sher3_effects.geometry.drawing import metres, shift
from sher3_effects.page import TIP_POSE, Page, Tolerated
from sher3_effects.view import RobotView


class ToolOffset(Page):
    """The tip in {a} is off by x, y, z: a constant in the tool frame."""

    id, family, stage = "tool_offset", "geometry", "mechanism"
    inputs = ("posture",)
    seen_at = TIP_POSE
    best = Best("postures", "well-spread postures separate geometric errors")
    places = ("tip",)
    gives = ("x", "y", "z")
    explanation = (
        "The needle is bent or seated differently: the tip error is constant in the tool's own frame and "
        "turns with roll and tilt."
    )
    siblings = {
        "encoder_offset": "constant in one joint",
        "base_tilt": "constant in the base, the orientation is off too",
    }
    units = {"x": "m", "y": "m", "z": "m"}

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """Three columns: the axes of the tool frame."""
        columns = np.zeros((len(view.run.grid), 6, 3))
        columns[:, :3] = view.path.rotation
        return Signature(view.at_tip(columns))

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return where the tip is in the tool's frame."""
        return (Tolerated({}, {f"tool length, {a}": (robot.tolerances.tool, "m") for a in "xyz"}),)


@dataclass(frozen=True)
class ToolOffsetInPlant(PlantEffect, page=ToolOffset):
    """The tip is not where the tool is drawn to end."""

    x: float = metres(50e-6, "along x of {t}")
    y: float = metres(0.0, "along y of {t}")
    z: float = metres(0.0, "along z of {t}")

    def apply(self, p: PlantParameters) -> None:
        """Move the tip."""
        shift(p, tool_x=self.x, tool_y=self.y, tool_z=self.z)
