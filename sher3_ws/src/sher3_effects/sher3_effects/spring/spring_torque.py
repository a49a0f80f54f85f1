"""Spring torque: a force in proportion to the position."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.compliance.two_slopes import BENT_FROM
from sher3_effects.page import Page
from sher3_effects.travel import over_travel, share_of
from sher3_effects.view import AxisView, NominalAxis


class SpringTorque(Page):
    """F = stiffness * (q - rest)."""

    id, family, stage = "spring_torque", "spring", "motor_mechanics"
    inputs = ("position",)
    above = 0.0
    kinds: ClassVar[tuple[str, ...]] = ("joint",)
    plain = True
    best = Best("sweep", "long constant-speed strokes separate ratios from offsets")
    extends: ClassVar[tuple[str, ...]] = ("gravity_load",)
    extends_by = ("stiffness",)
    explanation = (
        "A spring pulls the axis to one place: a force that grows in proportion to the distance from it, the same "
        "going and coming."
    )
    siblings = {
        "gravity_load": "follows the sine of the posture, or is constant",
        "cogging": "repeats with every turn of the motor",
    }
    units: ClassVar[Mapping[str, str]] = {"stiffness": "N/m", "rest": "m"}
    on_axis = {"stiffness": "spring", "rest": "rest"}

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return two columns: the position, and ones."""
        q = view.position[:, view.row(site)]
        return Signature({Channel(self.stage, site): column(q, np.ones_like(q))})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the stiffness, and the position at which the spring is relaxed, of coefficients (2,)."""
        stiffness, at_zero = map(float, coefficients)
        return {"stiffness": stiffness, "rest": -at_zero / stiffness if stiffness else 0.0}


class SpringOnAxis(SpringTorque):
    """The same on one axis of any machine.

    A spring that hardens towards the ends of the travel has a cube of the position beside it; one that softens is a
    weight at an arm.
    """

    kinds: ClassVar[tuple[str, ...]] = ("axis",)
    plain = True
    units = {"stiffness": "N/m", "rest": "m", "stiffness_at_end": "N/m"}
    bent_from = BENT_FROM
    parted_by_travel = BENT_FROM

    def on(self, axis: NominalAxis) -> Page:
        """Return the page beside a weight at an arm where the axis may carry a weight."""
        return SpringBesideWeight() if axis.weighed else self

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return the middle and half of the travel over all runs."""
        return over_travel(views, site, {})

    def bends(self, views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
        """Return the spring that hardens."""
        return [{**shape, "hardens": 1.0}]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return two columns, the position over its travel and one; of a spring that hardens its cube too."""
        x = share_of(view.position[:, view.row(site)], shape)
        cube = [x**3] if "hardens" in shape else []
        return Signature({Channel(self.stage, site): column(x, np.ones_like(x), *cube)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return stiffness, the position at which the spring is relaxed, (2,), and the stiffness at the ends, (3,)."""
        linear, middle, *cube = map(float, coefficients)
        place = _relaxed(linear, middle, *cube) if linear else 0.0
        out = {"stiffness": linear / shape["half"], "rest": shape["middle"] + shape["half"] * place}
        return {**out, **({"stiffness_at_end": (linear + 3.0 * cube[0]) / shape["half"]} if cube else {})}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the spring (p,) pulls back and does not soften; it may be strained all over the travel."""
        linear, _, cube = (*map(float, coefficients), 0.0)[:3]
        return linear > 0.0 and cube >= 0.0


class SpringBesideWeight(SpringOnAxis):
    """A spring on an axis that turns, whose description says nothing of a weight at an arm.

    Over a small travel a spring and the sine of a weight at an arm look alike. Neither law is a special case of the
    other, so they are rivals.
    """

    kinds = ()
    extends = ()


def _relaxed(linear: float, middle: float, cube: float = 0.0) -> float:
    """Return the place nearest to the middle, over half the travel, at which linear x + cube x^3 + middle is zero."""
    roots = np.roots([cube, 0.0, linear, middle])
    real = roots[np.abs(roots.imag) <= 1e-9 * (1.0 + np.abs(roots))].real
    return float(real[np.argmin(np.abs(real))])
