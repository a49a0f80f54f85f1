"""Base tilt: the whole robot leans against the frame of measurement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect
from sher3_sim.parameters import PlantParameters

from sher3_effects.geometry.drawing import radians, shift
from sher3_effects.page import TIP_POSE, Page
from sher3_effects.view import RobotView


class BaseTilt(Page):
    """{b} is rotated by two small angles about x and y."""

    id, family, stage = "base_tilt", "geometry", "mechanism"
    inputs = ("posture",)
    seen_at = TIP_POSE
    best = Best("postures", "well-spread postures separate geometric errors")
    places = ("tip",)
    explanation = (
        "The base leans: position and orientation of the tip are rotated about the origin of the base, the "
        "same in every pose."
    )
    siblings = {"rail_tilt": "one rail only, the orientation stays", "tool_offset": "turns with the tool"}
    units = {"angle": "rad"}

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """Two columns: about x and about y."""
        change = [view.geometry.pose_change(view.run, 1e-4, **{f"base_{a}": 1.0}) for a in "xy"]
        return Signature(view.at_tip(np.stack(change, axis=-1)))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the angle and its components (2,) [rad]."""
        return {"angle": float(np.hypot(*coefficients)), "x": float(coefficients[0]), "y": float(coefficients[1])}


@dataclass(frozen=True)
class BaseTiltInPlant(PlantEffect, page=BaseTilt, sites=("tip", "all")):
    """The whole robot stands tilted in the frame in which its tip is measured."""

    x: float = radians(1e-3, "rotation about x of {b}")
    y: float = radians(0.0, "rotation about y of {b}")

    def apply(self, p: PlantParameters) -> None:
        """Rotate the base."""
        shift(p, base_x=self.x, base_y=self.y)
