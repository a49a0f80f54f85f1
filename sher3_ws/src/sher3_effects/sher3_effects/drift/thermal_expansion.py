"""Thermal expansion: the structure grows with its temperature."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import SLIDERS, PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.drift.warmth import warm, warming
from sher3_effects.page import TIP_POSE, Page, Tolerated
from sher3_effects.table_view import TableView
from sher3_effects.view import RobotView


class ThermalExpansion(Page):
    """Lengths grow by coefficient * (T - 22 deg C): the links, the arm, the rails, or everything."""

    id, family, stage = "thermal_expansion", "drift", "mechanism"
    inputs = ("temperature", "posture", "position")
    seen_at = TIP_POSE
    gives = ("coefficient", "part")
    best = Best("postures", "the same postures again at another temperature separate drift from offset")
    places = ("tip",)
    discrete = frozenset({"part"})
    explanation = (
        "The tip wanders with the temperature of the structure, in every pose, in proportion to the warming "
        "since 22 deg C."
    )
    siblings = {
        "tool_offset": "does not change with temperature",
        "link_length_error": "does not change with temperature",
    }

    def shapes(self, views: Sequence[RobotView], site: str) -> list[Shape]:
        """What grows: 0 everything, 1 the links, 2 the arm, 3 the slider travel."""
        if not warm(views):
            return []
        return [{"part": float(i)} for i in range(4)]

    def _growth(self, view: RobotView, part: int) -> Array:
        p = view.geometry.parameters
        links = {f"link_{k}": getattr(p, f"link_{k}") for k in (1, 2, 3)}
        arm = {n: getattr(p, n) for n in ("d1", "d2", "d3", "tool_x", "tool_y", "tool_z")}
        if part == 3:
            q = view.geometry.positions(view.run)
            return np.einsum("gik,gk->gi", view.path.jacobian[:, :, [0, 1, 2, 4]], q[:, [0, 1, 2, 4]])
        if part == 0:
            growth = np.zeros((len(view.run.grid), 6))
            growth[:, :3] = view.path.position
            return growth
        return view.geometry.pose_change(view.run, 1e-5, **(links if part == 1 else arm))

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """One column: growth per unit of strain, times the warmth."""
        growth = self._growth(view, int(shape["part"])) * view.warmth[:, None]
        return Signature(view.at_tip(growth[:, :, None]))

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the growth of everything."""
        return (Tolerated({"part": 0.0}, {"expansion": (robot.tolerances.expansion, "1/K")}),)


class TableExpansion(Page):
    """A positioning table that grows with its own temperature: deviation = coefficient * (T - reference) * target.

    Targets count from the middle of the travel. A table that warms up during the test may be fixed at any place, such
    as the fixed bearing of its screw: then deviation = coefficient * (T - reference) * (target - rest).
    """

    id, family, best = ThermalExpansion.id, ThermalExpansion.family, ThermalExpansion.best
    stage, places = "transmission", ("axis",)
    kinds: ClassVar[tuple[str, ...]] = ("table",)
    inputs = ("temperature", "position")
    units = {"coefficient": "1/K", "rest": "m"}
    explanation = "The table moves too far by a share of its travel that follows its temperature."
    siblings = {"lead_error": "the same share at every temperature"}

    def shapes(self, views: Sequence[Any], site: str) -> list[Shape]:
        """Return a shape fixed at the middle, if any run was warmer, and one fixed anywhere, if any run warmed up."""
        middle: list[Shape] = [{}] if warm(views) else []
        return [*middle, {"half": 0.5 * float(np.ptp(views[0].nodes))}] if warming(views) else middle

    def signature(self, view: TableView, site: str, shape: Shape) -> Signature:
        """Return warmth (K above the reference) times target; where any place may be fixed, the warmth too."""
        parts = [view.target * view.warmth, *([view.warmth] if shape else [])]
        return Signature({Channel(self.stage, site): column(*parts)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the coefficient of expansion beyond that of the reading, and the place that stays where it is.

        Coefficients: that of the target (1,) [1/K]; where any place may be fixed, that of the warmth too (2,).
        """
        a, *still = map(float, coefficients)
        return {"coefficient": a, **({"rest": -still[0] / a if a else 0.0} if still else {})}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the place that stays, of (2,), is in the travel or half of it beyond: a bearing is near it.

        An axis between two encoders may be clamped anywhere: its shape tells no travel.
        """
        return not shape or abs(float(coefficients[1])) <= 2.0 * shape["half"] * abs(float(coefficients[0]))


class ExpansionOnAxis(TableExpansion):
    """The same between two encoders of any axis: load - motor = coefficient * (T - 20 deg C) * (position - rest)."""

    kinds, needs = ("axis", "servo"), ("load", "temperature")
    explanation = "Screw, belt or frame grow between the two encoders, in proportion to their warmth and to the travel."

    def shapes(self, views: Sequence[Any], site: str) -> list[Shape]:
        """Return one shape where the temperature changed; at one temperature expansion is a ratio of the axis."""
        return [{}] if warming(views) else []

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return two columns: the warmth times the position, and the warmth."""
        place = view.position[:, view.row(site)]
        return Signature({Channel(self.stage, site): column(place * view.warmth, view.warmth)})


@dataclass(frozen=True)
class ThermalExpansionInPlant(PlantEffect, page=ThermalExpansion, sites=(*SLIDERS, "tilt", "tip", "all")):
    """The structure grows with its temperature: one slide, the whole robot from its base, or a part of it."""

    coefficient: float = parameter("1/K", 12e-6, -1e-3, 1e-3, "relative growth per kelvin")
    part: float = parameter("1", 0.0, 0.0, 3.0, "what grows: 0 everything, 1 the links, 2 the arm, 3 all slides")

    def apply(self, p: PlantParameters) -> None:
        """Grow one slide, or a part of the robot."""
        if self.actuator in ACTUATORS:
            p.axis["expansion"][self.rows] += self.coefficient
        elif round(self.part) == 3:
            p.axis["expansion"][[0, 1, 2, 4]] += self.coefficient
        else:
            p.body[("expansion", "link_expansion", "arm_expansion")[round(self.part)]] += self.coefficient
