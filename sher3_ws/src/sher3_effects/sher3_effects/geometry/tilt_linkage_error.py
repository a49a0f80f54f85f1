"""Tilt linkage: a member of the slider-crank differs from the drawing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import Robot
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect
from sher3_sim.parameters import PlantParameters

from sher3_effects.geometry.drawing import metres, shift
from sher3_effects.geometry.encoder_offset import EncoderOffset
from sher3_effects.page import TIP_POSE, Page, Part, Tolerated, Values
from sher3_effects.view import RobotView


class TiltLinkageError(Page):
    """Crank, coupler or offset of the tilt linkage is off by `length`."""

    id, family, stage = "tilt_linkage_error", "geometry", "mechanism"
    inputs = ("position", "posture")
    seen_at = TIP_POSE
    best = Best("postures", "well-spread postures separate geometric errors")
    places = ("tilt",)
    gives = ("length", "member", "drawn_zero")
    explanation = (
        "The tilt angle is not the one its slider should give: the tip turns too far or not far enough, by an "
        "amount that depends on the tilt."
    )
    siblings = {
        "encoder_offset": "a constant slider error",
        "encoder_scale": "the load encoder disagrees with the motor's",
    }
    units = {"length": "m", "member": "1"}
    MEMBERS = ("crank", "coupler", "offset")
    tried = tuple({"member": float(i), "drawn_zero": z} for i in range(3) for z in (0.0, 1.0))
    """Which member, and whether the slider has its zero where the linkage has no tilt, as built (0) or as drawn (1)."""

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """One column: the change of the pose per metre."""
        member = self.MEMBERS[int(shape["member"])]
        p = view.geometry.parameters
        reach = np.sqrt(p.coupler**2 - (p.offset - p.crank) ** 2)
        slope = {"crank": p.offset - p.crank, "coupler": p.coupler, "offset": p.crank - p.offset}[member] / reach
        change = view.geometry.pose_change(view.run, 1e-5, **{member: 1.0, "zero_5": -shape["drawn_zero"] * slope})
        return Signature(view.at_tip(change[:, :, None]))

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the lengths of the members."""
        limit = (robot.tolerances.four_bar, "m")
        return [
            Tolerated({"member": float(i), "drawn_zero": 0.0}, {f"{member} of the tilt linkage": limit})
            for i, member in enumerate(self.MEMBERS)
        ]

    def to_simulator(self, actuator: str, values: Values, robot: Robot) -> list[Part]:
        """Return the member's error, beside an encoder offset where the axis has its own zero: the plant's is drawn."""
        member = ("crank", "length", "offset")[int(values.get("member", 1))]  # the plant calls the coupler's `length`
        error = Part(self.id, actuator, {"length": 0.0, member: values["length"]})
        if values.get("drawn_zero", 1.0):
            return [error]
        drawn = robot.tilt_linkage
        built = {"crank": drawn.crank, "length": drawn.coupler, "offset": drawn.offset}
        built[member] += values["length"]
        reach = math.sqrt(built["length"] ** 2 - (built["offset"] - built["crank"]) ** 2)
        moved = math.sqrt(drawn.coupler**2 - (drawn.offset - drawn.crank) ** 2) - reach
        return [error, Part(EncoderOffset.id, actuator, {"offset": moved})]


@dataclass(frozen=True)
class TiltLinkageErrorInPlant(PlantEffect, page=TiltLinkageError):
    """The crank, the coupler or the offset of the tilt linkage is not as drawn: the ratio changes along the travel."""

    length: float = metres(50e-6, "coupler less nominal")
    crank: float = metres(0.0, "crank less nominal")
    offset: float = metres(0.0, "offset less nominal")

    def apply(self, p: PlantParameters) -> None:
        """Change the linkage; zero of the slider stays where the nominal linkage has zero angle."""
        nominal = p.robot.tilt_linkage
        shift(p, coupler=self.length, crank=self.crank, offset=self.offset)
        g = p.geometry
        built = math.sqrt(g.coupler**2 - (g.offset - g.crank) ** 2)
        drawn = math.sqrt(nominal.coupler**2 - (nominal.offset - nominal.crank) ** 2)
        shift(p, zero_5=drawn - built)
