"""Tendon friction: a cable rubs in its sheath, so that its stretch depends on the direction and on the tension."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.operators import sheath
from sher3_effects.page import Page
from sher3_effects.travel import over_travel, share_of
from sher3_effects.view import AxisView


class TendonFriction(Page):
    """load = motor - mean tension / stiffness of a tendon whose tension changes along its sheath (Euler, 1769).

    With the tension recorded at the motor, that of every piece of the sheath follows: `operators.sheath`. Without it
    the width of the loop grows along the travel, as the tension does: load = motor - z (middle + slope x), x = -1..1,
    z the Dahl state over a displacement: what the motor travels before all of the sheath slides the other way.
    """

    id, family, stage = "tendon_friction", "lost_motion", "transmission"
    inputs = ("direction", "force", "position")
    kinds = ("axis", "servo")
    needs = ("load",)
    best = Best("loads", "a recorded tension under several loads separates rubbing from a gap")
    leaves_out = "how its friction differs along the sheath"
    extends = ("transmission_hysteresis", "transmission_compliance")
    explanation = (
        "A cable rubs where it is led round: it is stretched by less of its tension going than coming: the loop "
        "between motor and joint is wide where the cable is tight, and closes where it is slack."
    )
    siblings = {
        "backlash": "the same width whatever the tension",
        "transmission_hysteresis": "the same width whatever the tension; builds up over a stroke",
        "transmission_compliance": "no loop",
    }
    units = {"stiffness": "N/m", "wrap": "1", "width": "m", "growth": "1", "displacement": "m"}
    bounds = {"wrap": (0.0, np.inf), "stiffness": (0.0, np.inf), "width": (0.0, np.inf), "displacement": (0.0, np.inf)}
    finer = {"displacement": (0.7, 0.85, 1.2, 1.4), "wrap": (0.7, 0.85, 0.93, 1.07, 1.2, 1.4)}
    WRAPS = (0.05, 0.1, 0.2, 0.4, 0.8, 1.6)
    """Friction times angle: half a turn of a bare cable on steel has 0.5, two turns in a dry sheath 2."""
    SHARES = (0.005, 0.01, 0.02, 0.04, 0.08, 0.16)
    """Displacements that are tried, as shares of the travel."""
    GROWS = 0.2
    """Slope of the width over its middle from which it grows: below it the loop is that of a plain hysteresis."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return wraps where a tension was recorded, and displacements of a loop that grows along the travel."""
        row = views[0].row(site)
        travel = max(v.axis(site).travel for v in views)
        tight = all(v.run.effort is not None and self._tension(v, row).min() > 0.0 for v in views)
        tried: list[Shape] = [{"displacement": s * travel} for s in self.SHARES if travel]
        loops = [found for shape in tried for found in over_travel(views, site, shape)]
        return [*loops, *({"wrap": w} for w in self.WRAPS if tight)]

    def _tension(self, view: AxisView, row: int) -> Array:
        """Return the recorded tension (n,) after the low-pass, N: its noise would rub as well."""
        found: Array = view.run.filtered(view.run.effort[:, [row]])
        return np.ascontiguousarray(found[:, 0])

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return the mean tension along the sheath, or two columns: the loop and its growth along the travel."""
        run, row = view.run, view.row(site)
        if "wrap" in shape:
            mean = np.exp(sheath(np.log(self._tension(view, row)), shape["wrap"])).mean(axis=1)
            return Signature({Channel(self.stage, site): column(-run.to_grid(mean[:, None])[:, 0])})
        z = view.sliding(row, shape["displacement"])
        x = share_of(run.smooth[:, row], shape)
        return Signature({Channel(self.stage, site): column(-run.to_grid(z), -run.to_grid(z * x))})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return stiffness and wrap, or width in the middle of the travel, its growth to the end, and displacement.

        Coefficients: the compliance (1,) of a tendon with a wrap; else half the width, and how it grows (2,).
        """
        first = float(coefficients[0])
        if "wrap" in shape:
            return {"stiffness": 1.0 / first if first else 0.0, "wrap": shape["wrap"]}
        growth = float(coefficients[1]) / first if first else 0.0
        return {"width": 2.0 * first, "growth": growth, "displacement": shape["displacement"]}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the tendon (1,) gives way, or the loop (2,) is one at both ends and grows from one of them."""
        first = float(coefficients[0])
        if "wrap" in shape:
            return first > 0.0
        return bool(first > 0.0 and self.GROWS * first < abs(coefficients[1]) <= first)
