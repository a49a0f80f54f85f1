"""Common part of the pages that look for a load behind the only encoder of an axis: the effort shows it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Shape

from sher3_effects.page import Page
from sher3_effects.view import AxisView, NominalAxis


class BehindMotor(Page):
    """effort = mass a + load_mass (a_load - a), where the law of the effect gives the load's acceleration.

    Attributes:
        mass: all that moves, kg or kg m^2; that of the load is a part of it.
    """

    kinds = ("axis",)
    seen_at = (("motor_mechanics", ""),)
    needs: ClassVar[tuple[str, ...]] = ("alone", "drive")
    unseen = True
    on_axis: ClassVar[Mapping[str, str]] = {}
    LEAST_SHARE = 0.05
    """Share of the mass that must be behind the motor, at least: less is an error of the mass."""

    def __init__(self, mass: float = np.inf) -> None:
        self.mass = mass

    def on(self, axis: NominalAxis) -> BehindMotor:
        """Return the page with the mass of the axis."""
        return type(self)(axis.mass)

    def weighs(self, views: Sequence[AxisView], site: str) -> bool:
        """Return whether there is a force balance to look at: a mass, and an effort in every run."""
        return views[0].axis(site).mass > 0.0 and all(v.run.effort is not None for v in views)

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the load's mass, first of (p,), is above `LEAST_SHARE` of the axis' mass and below all."""
        least = self.LEAST_SHARE * self.mass if np.isfinite(self.mass) else 0.0
        return bool(least < coefficients[0] < self.mass)
