"""Platform geometry: the joints of a leg, or of all legs, are not where drawn."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import SLIDERS, PlantEffect
from sher3_sim.parameters import PlantParameters

from sher3_effects.geometry.drawing import direction, metres, shift
from sher3_effects.page import TIP_POSE, Page, Part, Tolerated, Values
from sher3_effects.view import RobotView

OF_A_LEG = ("x", "y", "difference")
OF_EVERY_LEG = tuple(f"{name}_{k}" for k in range(1, 4) for name in OF_A_LEG)
BOTH_UNLIKE = 3.0
"""Value of `ball` for both balls of a leg, not quite alike."""


class PlatformGeometryError(Page):
    """Ball joints of one leg displaced by x, y in {b}: they shift the leg's anchor. Or of all, each by its own."""

    id, family, stage = "platform_geometry_error", "geometry", "mechanism"
    inputs = ("posture",)
    seen_at = TIP_POSE
    best = Best("postures", "well-spread postures separate geometric errors")
    places = ("leg", "tip")
    explanation = (
        "The ball joints of the platform or the base are off sideways: the tip error changes smoothly with "
        "the position of the platform, not with roll or tilt."
    )
    siblings = {"link_length_error": "along the leg", "rail_tilt": "grows with the height of the slider"}
    units = dict.fromkeys((*OF_A_LEG, "radius", *OF_EVERY_LEG), "m")
    EVERY = 4.0
    """Value of `ball` for the balls of every leg at once."""

    def bends(self, views: Sequence[RobotView], site: str, shape: Shape) -> list[Shape]:
        """Return the balls of all legs, each off by its own: a platform bored wrong has more than one wrong hole."""
        return [{"ball": self.EVERY}] if site == "tip" else []

    def shapes(self, views: Sequence[RobotView], site: str) -> list[Shape]:
        """Which of the leg's two balls: both (0), the first (1), the second (2), both but not quite alike (3)."""
        return [{"ball": 0.0}] if site == "tip" else [{"ball": float(b)} for b in range(4)]

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """Two columns (x, y of the balls) per leg, a third for how the two differ along it, or one: the radius of all.

        A ball displaced by d changes what its link spans by u . d, u the link's direction.
        """
        if shape["ball"] == self.EVERY:
            legs = [self._leg_columns(view, row, BOTH_UNLIKE) for row in range(len(SLIDERS))]
            return Signature(view.at_tip(-np.concatenate(legs, axis=2)))
        azimuth = view.robot.delta.leg_azimuth
        span = view.links[:, :3]
        if site == "tip":
            outward = np.repeat([[np.cos(a), np.sin(a), 0.0] for a in azimuth], 2, axis=0)
            change = np.einsum("gij,gkj,jk->gi", view.link_changes, span, outward)[:, :, None]
        else:
            change = self._leg_columns(view, view.row(site), shape["ball"])
        return Signature(view.at_tip(-change))

    def _leg_columns(self, view: RobotView, row: int, ball: float) -> Array:
        """Return the change of the pose (g, 6, 2 or 3) per metre of x, y of a leg's balls, and of their difference."""
        first = 2 * row
        links = {1: (first,), 2: (first + 1,)}.get(int(ball), (first, first + 1))
        change = sum(view.link_changes[:, :, [j]] * view.links[:, :3][:, None, :2, j] for j in links)
        if ball != BOTH_UNLIKE:
            return np.asarray(change)
        apart = view.link_changes[:, :, [first]] - view.link_changes[:, :, [first + 1]]
        return np.concatenate([change, apart], axis=2)

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return both balls of both ends of the leg, sideways."""
        if site == "tip":
            return ()
        limit = (math.sqrt(2.0) * robot.tolerances.ball_centre, "m")
        names = {b: {f"ball centres {b:.0f} of {site}, {a}": limit for a in "xy"} for b in (1.0, 2.0)}
        return [Tolerated({"ball": b}, limits) for b, limits in names.items()]

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the offsets (p,) [m] of the platform's joint, or of those of every leg."""
        names = {1: ("radius",), len(OF_EVERY_LEG): OF_EVERY_LEG}.get(len(coefficients), OF_A_LEG)
        return {n: float(c) for n, c in zip(names, coefficients, strict=False)}

    def to_simulator(self, actuator: str, values: Values, robot: Robot) -> list[Part]:
        """Return radial and tangential offsets of one leg or of each, or the same radius on all three."""
        if "radius" in values:
            return [Part(self.id, leg, {"x": values["radius"], "y": 0.0}) for leg in SLIDERS]
        if "x_1" in values:
            each = {leg: (values[f"x_{k}"], values[f"y_{k}"]) for k, leg in enumerate(SLIDERS, 1)}
        else:
            each = {actuator: (values["x"], values["y"])}
        return [self._turned(robot, leg, *moved) for leg, moved in each.items()]

    def _turned(self, robot: Robot, leg: str, x: float, y: float) -> Part:
        """Return the offsets of a leg, radial and tangential."""
        azimuth = robot.delta.leg_azimuth[ACTUATORS.index(leg)]
        c, s = math.cos(azimuth), math.sin(azimuth)
        return Part(self.id, leg, {"x": c * x + s * y, "y": c * y - s * x})


@dataclass(frozen=True)
class PlatformGeometryErrorInPlant(PlantEffect, page=PlatformGeometryError, sites=SLIDERS):
    """The ball joints of one leg sit elsewhere on the platform than drawn, radially and tangentially."""

    x: float = metres(20e-6, "outwards, along the leg's azimuth")
    y: float = metres(0.0, "sideways, towards growing azimuth")

    def apply(self, p: PlantParameters) -> None:
        """Move the platform ball pair: the leg's anchor is the base pair less the platform pair."""
        leg = self.rows[0] + 1
        c, s = direction(p, self.rows[0])
        shift(p, **{f"anchor_{leg}x": -(c * self.x - s * self.y), f"anchor_{leg}y": -(s * self.x + c * self.y)})
