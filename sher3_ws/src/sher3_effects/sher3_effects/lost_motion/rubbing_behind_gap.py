"""Friction behind a gap: a brake, a seal or a damper that is taken along only once its play is used up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.operators import play
from sher3_effects.page import Page
from sher3_effects.view import AxisView


class RubbingBehindGap(Page):
    """F = load_friction * z, z zero within a gap of `width` and -1..1 over `reach` on either side, where it slides.

    A play in series with an elastic, perfectly plastic element (Prandtl 1928).
    """

    id, family, stage = "rubbing_behind_gap", "lost_motion", "motor_mechanics"
    inputs = ("direction",)
    above = 0.0
    kinds, needs = ("axis",), ("drive",)
    dry = True
    extends = ("coulomb_friction", "presliding_friction")
    extends_by = ("width",)
    best = Best("reversals", "reversals of several amplitudes show a travel that needs no force")
    leaves_out = "how its level varies over the stroke"
    explanation = (
        "After a reversal the axis moves for a fixed travel without any friction; then what rubs is taken along."
    )
    siblings = {
        "presliding_friction": "the force builds up from the reversal on, without a travel that needs none",
        "backlash": "a mass is behind the gap too, and strikes at its end",
    }
    gives = ("width", "load_friction", "reach")
    units = {"width": "m", "load_friction": "N", "reach": "m"}
    bounds = {"width": (0.0, np.inf), "load_friction": (0.0, np.inf), "reach": (0.0, np.inf)}
    WIDTHS = (0.01, 0.02, 0.04, 0.07, 0.1, 0.15, 0.25)
    """In shares of the travel."""
    REACHES = (0.003, 0.01, 0.03)
    """Travel over which the force builds up behind the gap, in shares of the whole."""
    MOST = 0.5
    """Share of the travel that gap and reach may take: beyond it nothing slides."""
    COUNTS = 4.0
    """Smallest width of a gap, in counts or standard deviations of the encoder's noise."""
    finer = {"width": (0.7, 0.85, 0.93, 1.07, 1.2, 1.4), "reach": (0.5, 0.7, 1.4, 2.0)}

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return widths and reaches, m or rad; none where no force was recorded."""
        travel = max(v.axis(site).travel for v in views)
        tried: list[Shape] = [{"width": w * travel, "reach": r * travel} for w in self.WIDTHS for r in self.REACHES]
        measured = all(v.run.effort is not None for v in views)
        return [shape for shape in tried if measured and self.allowed(views, site, shape)]

    def allowed(self, views: Sequence[AxisView], site: str, shape: Shape) -> bool:
        """Return whether a gap is wider than what the encoder sees, and leaves a travel to slide on."""
        travel = max(v.axis(site).travel for v in views)
        seen = self.COUNTS * views[0].axis(site).seen
        return bool(seen < shape["width"] and shape["width"] + 2.0 * shape["reach"] < self.MOST * travel)

    def limits(self, shape: Shape) -> Mapping[str, tuple[float, float]]:
        """Return the bounds: a gap narrower than the travel over which its friction builds up does not show."""
        return {**self.bounds, "width": (shape["reach"], np.inf)}

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return one column: z, how far the follower lags beyond the gap, over `reach`; -1..1."""
        path, reach = np.ascontiguousarray(view.run.smooth[:, view.row(site)]), shape["reach"]
        behind = -play(path, shape["width"] + 2.0 * reach)
        z = np.sign(behind) * np.maximum(np.abs(behind) - 0.5 * shape["width"], 0.0) / reach
        return Signature({Channel(self.stage, site): column(view.run.to_grid(z[:, None])[:, 0])})
