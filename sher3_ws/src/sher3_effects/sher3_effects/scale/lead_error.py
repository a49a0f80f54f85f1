"""Lead error: a constant ratio between motor and load."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sher3_description import Robot
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter

from sher3_effects.page import Page, Tolerated
from sher3_effects.scale.varying_ratio import gentle, lines, mean_ratio
from sher3_effects.table_view import TableView
from sher3_effects.travel import over_travel
from sher3_effects.view import AxisView, without_force


class LeadError(Page):
    """load = (1 + relative) * motor; the ratio may vary along the travel, and `relative` is its mean."""

    id, family, stage = "lead_error", "scale", "transmission"
    inputs = ("position",)
    needs = ("load",)
    best = Best("sweep", "long constant-speed strokes separate ratios from offsets")
    leaves_out = "how the ratio varies from one turn to the next"
    on_axis = {"relative": "ratio"}
    explanation = (
        "The load moves a little more or less than the motor, in proportion to the travel; the load encoder "
        "and the tip agree."
    )
    siblings = {
        "encoder_scale": "the tip does not follow the load encoder",
        "thermal_expansion": "grows with temperature",
    }

    LARGEST = 0.2
    """Ratio error from which it is no lead error: four times the largest that the plant takes."""

    def bends(self, views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
        """Return the ratio that varies along the travel."""
        return over_travel(views, site, shape)

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """One column, the motor position; of a ratio that varies a hat over each of its nodes too."""
        return Signature({Channel(self.stage, site): column(*lines(view.position[:, view.row(site)], shape))})

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the ratio of motor to load."""
        return (Tolerated({}, {f"ratio of {site}": (robot.tolerances.ratio, "1")}),)

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the ratio error: the slope of the straight line nearest to the broken one of (p,)."""
        return {"relative": mean_ratio(coefficients)}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether (p,) is an error of a lead; more is a wrong scale, or an encoder that does not follow."""
        return bool(abs(coefficients[0]) < self.LARGEST) and gentle(coefficients)


class LeadErrorOnAxis(LeadError):
    """The same on one axis of any machine, with a ratio of 1."""

    kinds = ("axis", "servo")
    plain = True
    bends = Page.bends

    def plain_shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return one shape where no force was recorded: a spring that a force tells gives way along the travel too."""
        return self.shapes(views, site) if without_force(views) else []


class TableScale(Page):
    """A positioning table that moves a little more or less than its target: deviation = relative * target."""

    id, family, stage, best = LeadError.id, LeadError.family, LeadError.stage, LeadError.best
    kinds, inputs = ("table",), LeadError.inputs
    gives = ("relative",)
    on_axis = LeadError.on_axis
    explanation = "The table moves too far or too little in proportion to its travel, at every temperature."
    siblings = {"thermal_expansion": "grows with temperature"}

    def signature(self, view: TableView, site: str, shape: Shape) -> Signature:
        """Return one column: the target."""
        return Signature({Channel(self.stage, site): column(view.target)})


@dataclass(frozen=True)
class LeadErrorInPlant(PlantEffect, page=LeadError):
    """The load moves by a constant ratio more than the motor encoder says: lead of the screw, reduction."""

    relative: float = parameter("1", 1e-3, -0.05, 0.05, "load over motor travel, less one", on="lead_error")
