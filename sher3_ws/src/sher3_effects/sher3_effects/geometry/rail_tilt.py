"""Rail tilt: a rail is not parallel to z of the base."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect
from sher3_sim.parameters import PlantParameters

from sher3_effects.geometry.drawing import radians, shift
from sher3_effects.page import TIP_POSE, Page, Part, Tolerated, Values
from sher3_effects.view import ArmView, RobotView


class RailTilt(Page):
    """Rail k leans by two small angles: its slider wanders sideways as it climbs."""

    id, family, stage = "rail_tilt", "geometry", "mechanism"
    inputs = ("position", "posture")
    seen_at = TIP_POSE
    best = Best("postures", "well-spread postures separate geometric errors")
    places = ("leg",)
    explanation = "A rail leans: the tip error grows in proportion to the height of that slider."
    siblings = {"base_tilt": "the whole robot leans", "platform_geometry_error": "does not grow with height"}
    units = {"x": "rad", "y": "rad"}

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """Two columns: leaning along x and along y of the base."""
        change = [view.geometry.pose_change(view.run, 1e-4, **{f"rail_{site[-1]}{a}": 1.0}) for a in "xy"]
        return Signature(view.at_tip(np.stack(change, axis=-1)))

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the lean of the rail along x and y."""
        return (Tolerated({}, {f"rail of {site}, {a}": (robot.tolerances.rail, "rad") for a in "xy"}),)

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the angle and its components (2,) [rad]."""
        return {"angle": float(np.hypot(*coefficients)), "x": float(coefficients[0]), "y": float(coefficients[1])}

    def to_simulator(self, actuator: str, values: Values, robot: Robot) -> list[Part]:
        """Return the lean with its direction counted from the leg's azimuth."""
        lean = math.atan2(values["y"], values["x"]) - robot.delta.leg_azimuth[ACTUATORS.index(actuator)]
        return [Part(self.id, actuator, {"angle": values["angle"], "azimuth": math.remainder(lean, 2.0 * math.pi)})]


class JointTilt(Page):
    """A joint whose axis leans by two small angles, about two directions across it."""

    id, family, stage, best = RailTilt.id, RailTilt.family, RailTilt.stage, RailTilt.best
    kinds, places = ("arm",), ("joint",)
    gives = ("tilt_1", "tilt_2")
    leaves_out = "small errors of the other joints"
    explanation = "The axis of one joint does not point where the drawing says."
    siblings = {"encoder_offset": "a turn about the joint's own axis", "link_length_error": "a shift, not a turn"}
    units = {"tilt_1": "rad", "tilt_2": "rad"}
    seen_at = (("", "tip"),)

    def signature(self, view: ArmView, site: str, shape: Shape) -> Signature:
        """Return two columns: turns about two directions across the axis, per rad."""
        frame = view.postures.frames[:, view.row(site), :3, :3]
        across = np.linalg.svd(view.own_axis(site)[None])[2][1:]
        parts = [view.turned(frame @ u, view.place(site)) for u in across]
        return Signature({self.channels(site)[0]: np.stack(parts, axis=-1)})


@dataclass(frozen=True)
class RailTiltInPlant(PlantEffect, page=RailTilt):
    """A rail is not vertical: it leans by an angle, towards a direction seen from the leg's azimuth."""

    angle: float = radians(1e-3, "lean from the vertical")
    azimuth: float = radians(0.0, "of the lean, from outwards towards growing azimuth", 7.0)

    def apply(self, p: PlantParameters) -> None:
        """Lean the rail's direction."""
        leg = self.rows[0] + 1
        towards = p.robot.delta.leg_azimuth[self.rows[0]] + self.azimuth
        lean = math.sin(self.angle)
        shift(p, **{f"rail_{leg}x": lean * math.cos(towards), f"rail_{leg}y": lean * math.sin(towards)})
