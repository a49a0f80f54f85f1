"""Torque constant: the real force is not the force that the drive reports."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sher3_description import Robot
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import EVERYWHERE, PlantEffect, parameter, scaled_by

from sher3_effects.page import Page, Tolerated
from sher3_effects.view import AxisView


class TorqueConstant(Page):
    """Real force = (1 + relative) * reported effort."""

    id, family, stage = "torque_constant", "scale", "motor_mechanics"
    inputs = ("force",)
    kinds = ("robot", "axis")
    plain = True
    scales = "drive gain"
    indistinct = ("controller_gain",)
    needs = ("drive", "forces")
    best = Best("sweep", "long constant-speed strokes separate ratios from offsets")
    leaves_out = "its bend at large forces"
    explanation = "Every force on the axis is off by the same ratio: gravity, acceleration and external load alike."
    siblings = {
        "viscous_friction": "only the part in proportion to speed",
        "payload_mass": "only inertia and weight",
        "gravity_load": "only weight",
    }
    on_axis = {"relative": "drive"}

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """One column: the force the motion needs. reported - needed = -relative / (1 + relative) * needed."""
        row = view.row(site)
        needed = view.inertial[:, row] - view.axis(site).of_step * view.acceleration[:, row]
        return Signature({Channel(self.stage, site): column(-needed)})

    def scales_model(self, shape: Shape) -> bool:
        """Return that it is a share of all forces that the model needs."""
        return True

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the torque constant of the axis."""
        return (Tolerated({}, {f"torque constant of {site}": (robot.tolerances.torque_constant, "1")}),)

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return force over reported effort, minus 1: c / (1 - c) of coefficients (1,)."""
        c = float(coefficients[0])
        return {"relative": c / (1.0 - c)}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the ratio that (1,) stands for is within a factor of three either way."""
        return bool(-2.0 < coefficients[0] < 0.67)


@dataclass(frozen=True)
class TorqueConstantInPlant(PlantEffect, page=TorqueConstant, sites=EVERYWHERE):
    """The force on the axis is not the force the drive reports: weak magnets, wrong constant, losses."""

    relative: float = parameter(
        "1", 0.05, -0.5, 1.0, "force over reported effort, less one", on="torque_scale", change=scaled_by
    )
