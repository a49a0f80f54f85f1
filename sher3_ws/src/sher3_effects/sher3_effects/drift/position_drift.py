"""Position drift: a table wanders while it is measured, at every target alike."""

from __future__ import annotations

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.table_view import TableView


class PositionDrift(Page):
    """deviation = over_test * share of the test that has passed."""

    id, family, stage = "position_drift", "drift", "transmission"
    kinds, places = ("table",), ("axis",)
    inputs = ("time",)
    units = {"over_test": "m"}
    best = Best("postures", "the same targets again and again separate drift from the map of the axis")
    explanation = "Every cycle stops a little further along than the one before: the machine or the set-up warms up."
    siblings = {"thermal_expansion": "grows with the distance from the middle", "encoder_offset": "does not wander"}

    def signature(self, view: TableView, site: str, shape: Shape) -> Signature:
        """Return one column: the share of the test that has passed."""
        return Signature({Channel(self.stage, site): column(view.elapsed)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the drift from the first row to the last."""
        return {"over_test": float(coefficients[0])}
