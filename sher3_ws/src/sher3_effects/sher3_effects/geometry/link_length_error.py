"""Link length: one leg of the delta is longer or shorter than drawn."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from sher3_description import Robot
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect
from sher3_sim.parameters import PlantParameters

from sher3_effects.geometry.drawing import metres, shift
from sher3_effects.page import TIP_POSE, Page, Tolerated
from sher3_effects.view import ArmView, RobotView


class LinkLengthError(Page):
    """Links of leg k: link_length + length +- difference."""

    id, family, stage = "link_length_error", "geometry", "mechanism"
    inputs = ("posture",)
    seen_at = TIP_POSE
    best = Best("postures", "well-spread postures separate geometric errors")
    places = ("leg",)
    gives = ("length", "difference")
    tried = ({"apart": 0.0}, {"apart": 1.0})
    """Both links alike (0), or one longer than the other too (1), by twice the `difference`: it turns the platform."""
    explanation = (
        "One leg of the delta is a little too long or short: the tip is off by an amount that changes "
        "smoothly with the pose."
    )
    siblings = {
        "encoder_offset": "the leg's slider is off along its rail",
        "platform_geometry_error": "a joint of the leg is off sideways",
        "tool_offset": "turns with the tool",
    }
    units = {"length": "m"}

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """Both links of the leg alike, and, apart, one against the other."""
        a, b = 2 * view.row(site), 2 * view.row(site) + 1
        both = view.link_changes[:, :, a] + view.link_changes[:, :, b]
        apart = view.link_changes[:, :, a] - view.link_changes[:, :, b]
        return Signature(view.at_tip(np.stack([both, apart] if shape["apart"] else [both], axis=-1)))

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return both links of the leg, each on its own; a ball's height shows as the length of its link."""
        limits = robot.tolerances
        limit = (math.hypot(limits.link_length, limits.ball_centre, limits.ball_centre) / math.sqrt(2.0), "m")
        names = (f"link length of {site}", f"difference of the links of {site}")
        return (Tolerated({"apart": 1.0}, dict.fromkeys(names, limit)),)


class JointPlace(Page):
    """A joint that sits elsewhere than drawn, shifted along the axes of its own frame."""

    id, family, stage, best = LinkLengthError.id, LinkLengthError.family, LinkLengthError.stage, LinkLengthError.best
    kinds, places = ("arm",), ("joint",)
    gives = ("x", "y", "z")
    leaves_out = "small errors of the other joints"
    explanation = "One link of the arm is longer, shorter or bent: a joint sits elsewhere than drawn."
    siblings = {"encoder_offset": "a turn about the joint's axis", "rail_tilt": "a turn across the joint's axis"}
    units = {"x": "m", "y": "m", "z": "m"}
    on_axis = {"x": "shift_x", "y": "shift_y", "z": "shift_z"}
    seen_at = (("", "tip"),)
    FURTHEST = 0.1
    """Shift, m, from which it is no error of an arm: drawing and measurement then do not belong together."""
    bounds: ClassVar[Mapping[str, tuple[float, float]]] = dict.fromkeys("xyz", (-FURTHEST, FURTHEST))

    def signature(self, view: ArmView, site: str, shape: Shape) -> Signature:
        """Return three columns: shifts along the axes of the joint frame, per m."""
        frame = view.postures.frames[:, view.row(site)]
        parts = [view.shifted(frame[:, :3, i]) for i in range(3)]
        return Signature({self.channels(site)[0]: np.stack(parts, axis=-1)})

    def unit(self, name: str, site: str, rotary: bool) -> str:
        """Return the unit of a length: the shifts of a joint are none of its turn."""
        return "m"


@dataclass(frozen=True)
class LinkLengthErrorInPlant(PlantEffect, page=LinkLengthError):
    """The two links of one leg are longer than drawn; where they also differ, the platform turns."""

    length: float = metres(20e-6, "mean length of the pair less nominal")
    difference: float = metres(0.0, "second link, towards growing azimuth, less the first")

    def apply(self, p: PlantParameters) -> None:
        """Lengthen the links."""
        shift(p, **{f"link_{self.rows[0] + 1}": self.length})
        p.body["link_difference"][0, self.rows] += self.difference
        p.body["gives_way"] |= self.difference != 0.0
