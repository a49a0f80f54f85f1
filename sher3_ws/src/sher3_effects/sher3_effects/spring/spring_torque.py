"""Spring torque: a force in proportion to the position."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.view import AxisView


class SpringTorque(Page):
    """F = stiffness * (q - rest)."""

    id, family, stage = "spring_torque", "spring", "motor_mechanics"
    inputs = ("position",)
    kinds = ("joint",)
    best = Best("sweep", "long constant-speed strokes separate ratios from offsets")
    extends = ("gravity_load",)
    explanation = (
        "A spring pulls the axis to one place: a force that grows in proportion to the distance from it, the same "
        "going and coming."
    )
    siblings = {
        "gravity_load": "follows the sine of the posture, or is constant",
        "cogging": "repeats with every turn of the motor",
    }
    units = {"stiffness": "N/m", "rest": "m"}
    on_axis = {"stiffness": "spring", "rest": "rest"}

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return two columns: the position, and one."""
        q = view.position[:, view.row(site)]
        return Signature({Channel(self.stage, site): column(q, np.ones_like(q))})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the stiffness, and the position at which the spring is relaxed."""
        stiffness, at_zero = map(float, coefficients)
        return {"stiffness": stiffness, "rest": -at_zero / stiffness if stiffness else 0.0}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the spring pulls back."""
        return bool(coefficients[0] > 0.0)
