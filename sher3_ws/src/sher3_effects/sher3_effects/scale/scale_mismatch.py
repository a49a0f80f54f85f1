"""Scale mismatch: two axes of a plane whose scales differ."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.table_view import CircleView


class ScaleMismatch(Page):
    """radius = R + relative * R / 2 * cos(2 phi): a circle becomes an ellipse along the axes."""

    id, family, stage = "scale_mismatch", "scale", "mechanism"
    kinds, places = ("circle",), ("plane",)
    inputs = ("posture",)
    gives = ("relative",)
    units = {"relative": "1"}
    best = Best("postures", "circles in both directions separate geometry from lost motion")
    explanation = "One axis of a plane moves further than the other: a circle becomes an ellipse along the axes."
    siblings = {"rail_tilt": "an ellipse along the diagonals", "backlash": "a step at the poles"}

    def signature(self, view: CircleView, site: str, shape: Shape) -> Signature:
        """Return one column: the change of the radius per unit of difference."""
        return Signature({self.channels(site)[0]: column(0.5 * view.radius * np.cos(2.0 * view.angle))})
