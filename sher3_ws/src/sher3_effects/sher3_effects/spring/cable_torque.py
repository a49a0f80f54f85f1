"""Cable torque: a force that is some function of the position."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.travel import Travel, travel_of
from sher3_effects.view import AxisView


class CableTorque(Page):
    """F = a + b x + c x^2 + d x^3 with x the position over its travel, -1..1."""

    id, family, stage = "cable_torque", "spring", "motor_mechanics"
    inputs = ("position",)
    kinds = ("joint",)
    best = Best("sweep", "long constant-speed strokes separate ratios from offsets")
    extends = ("gravity_load", "spring_torque")
    extends_by = ("span",)
    explanation = (
        "A cable or hose that is led along the joint pulls at it: a force that depends on the position alone, the same "
        "going and coming, stiffer towards the ends of the travel."
    )
    siblings = {
        "gravity_load": "follows the sine of the posture, or is constant",
        "position_friction": "the sign follows the direction of motion",
    }
    units = {
        "span": "N",
        "middle": "m",
        "half_travel": "m",
        "constant": "N",
        "linear": "N",
        "square": "N",
        "cubic": "N",
    }
    ALONG = np.linspace(-1.0, 1.0, 101)
    """Share of the travel at which the force is looked at for its span."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return the middle and half of the travel over all runs."""
        travel = travel_of(views, site)
        return [{"middle": travel.middle, "half_travel": travel.half}] if travel else []

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return four columns: the powers of the position over its travel."""
        x = Travel(shape["middle"], shape["half_travel"]).share(view.position[:, view.row(site)])
        return Signature({Channel(self.stage, site): column(np.ones_like(x), x, x**2, x**3)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the span of the force over the travel, the travel, and the force (4,) of each power at its end."""
        names = ("constant", "linear", "square", "cubic")
        span = float(np.ptp(np.polynomial.polynomial.polyval(self.ALONG, coefficients)))
        return {"span": span, **shape, **{name: float(c) for name, c in zip(names, coefficients, strict=True)}}
