"""Spring torque: a force in proportion to the position."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.view import AxisView


class SpringTorque(Page):
    """F = stiffness * (q - rest)."""

    id, family, stage = "spring_torque", "spring", "motor_mechanics"
    inputs = ("position",)
    kinds: ClassVar[tuple[str, ...]] = ("joint",)
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


class SpringOnAxis(SpringTorque):
    """The same on one axis of any machine: a spring is told from a constant force only where it rests in the travel."""

    kinds = ("axis",)

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return the middle and half of the travel over all runs."""
        ends = [f(v.position[:, v.row(site)]) for v in views for f in (np.min, np.max)]
        low, high = min(ends), max(ends)
        return [{"middle": 0.5 * (low + high), "half": 0.5 * (high - low)}] if high > low else []

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return two columns: the position over its travel, and one."""
        x = (view.position[:, view.row(site)] - shape["middle"]) / shape["half"]
        return Signature({Channel(self.stage, site): column(x, np.ones_like(x))})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the stiffness, and the position at which the spring is relaxed."""
        end, middle = map(float, coefficients)
        return {
            "stiffness": end / shape["half"],
            "rest": shape["middle"] - shape["half"] * middle / end if end else 0.0,
        }

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the spring pulls back, to a place within the travel."""
        return bool(coefficients[0] > abs(coefficients[1]))
