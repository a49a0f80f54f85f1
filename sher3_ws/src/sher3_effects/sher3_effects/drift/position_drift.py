"""Position drift: a table wanders while it is measured, at every target alike."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.table_view import TableView


class PositionDrift(Page):
    """deviation = over_test * share of the test that has passed; or the same that settles, as what warms up does."""

    id, family, stage = "position_drift", "drift", "transmission"
    kinds, places = ("table",), ("axis",)
    inputs = ("time",)
    gives = ("over_test", "settling")
    units = {"over_test": "m", "settling": "1"}
    best = Best("postures", "the same targets again and again separate drift from the map of the axis")
    explanation = "Every cycle stops a little further along than the one before: the machine or the set-up warms up."
    siblings = {"thermal_expansion": "grows with the distance from the middle", "encoder_offset": "does not wander"}

    SETTLING = (0.1, 0.2, 0.4, 0.8)
    """Shares of the test after which a drift has settled but for 1/e."""
    finer: ClassVar[Mapping[str, tuple[float, ...]]] = {"settling": (0.7, 0.85, 1.2, 1.4)}

    def bends(self, views: Sequence[TableView], site: str, shape: Shape) -> list[Shape]:
        """Return drifts that settle."""
        return [{"settling": share} for share in self.SETTLING]

    def signature(self, view: TableView, site: str, shape: Shape) -> Signature:
        """Return one column, zero at the first row and one at the last: how much of the drift has passed."""
        if "settling" not in shape:
            return Signature({Channel(self.stage, site): column(view.elapsed)})
        passed = np.expm1(-view.elapsed / shape["settling"]) / np.expm1(-1.0 / shape["settling"])
        return Signature({Channel(self.stage, site): column(passed)})
