"""Encoder offset: an axis was homed wrongly."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter

from sher3_effects.page import TIP_POSE, Page
from sher3_effects.view import ArmView, RobotView


class EncoderOffset(Page):
    """Both encoders of the axis read q + offset."""

    id, family, stage = "encoder_offset", "geometry", "mechanism"
    inputs = ("posture",)
    seen_at = TIP_POSE
    gives = ("offset",)
    breaks = "both_encoders"
    best = Best("postures", "well-spread postures separate geometric errors")
    explanation = (
        "Both encoders of an axis are off by the same constant: only the tip shows it, along that axis' "
        "direction of motion."
    )
    siblings = {
        "tool_offset": "constant in the tool frame",
        "link_length_error": "along the leg instead of along the rail",
    }

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """One column: minus the axis' Jacobian column."""
        return Signature(view.at_tip(-view.path.jacobian[:, :, [view.row(site)]]))


class JointOffset(Page):
    """A joint whose encoder reads too much by a constant, rad: the arm then turns less by as much."""

    id, family, stage, best = EncoderOffset.id, EncoderOffset.family, EncoderOffset.stage, EncoderOffset.best
    kinds, places = ("arm",), ("joint",)
    leaves_out = "small errors of the other joints"
    explanation = "The zero of one joint is off by a constant angle."
    siblings = {
        "link_length_error": "the error does not turn with the joint",
        "rail_tilt": "about an axis across the joint's",
    }
    gives = ("offset",)
    units = {"offset": "rad"}
    on_axis = {"offset": "zero"}
    plain = True
    seen_at = (("", "tip"),)

    def signature(self, view: ArmView, site: str, shape: Shape) -> Signature:
        """Return one column: minus the turn of everything behind the joint, per rad."""
        j = view.row(site)
        return Signature({self.channels(site)[0]: -view.turned(view.postures.axes[:, j], view.place(site))[:, :, None]})


@dataclass(frozen=True)
class EncoderOffsetInPlant(PlantEffect, page=EncoderOffset):
    """A homing error: both encoders of the axis read too much by the offset."""

    offset: float = parameter("m", 20e-6, -5e-3, 5e-3, "reading less true position", on="encoder_offset")
