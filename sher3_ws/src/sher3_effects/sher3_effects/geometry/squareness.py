"""Squareness: two axes that are not at right angles."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.table_view import CircleView


class Squareness(Page):
    """radius = R - angle * R / 2 * sin(2 phi): a circle becomes an ellipse that leans by 45 degrees."""

    id, family, stage = "squareness", "geometry", "mechanism"
    kinds, places = ("circle",), ("plane",)
    inputs = ("posture",)
    gives = ("angle",)
    units = {"angle": "rad"}
    best = Best("postures", "circles in both directions separate geometry from lost motion")
    explanation = "The axes of a plane are not at right angles: a circle becomes an ellipse along the diagonals."
    siblings = {"lead_error": "an ellipse along the axes", "backlash": "a step at the poles"}

    def signature(self, view: CircleView, site: str, shape: Shape) -> Signature:
        """Return one column: the change of the radius per rad beyond a right angle."""
        return Signature({self.channels(site)[0]: column(-0.5 * view.radius * np.sin(2.0 * view.angle))})
