"""Force hysteresis: a load cell reads otherwise when it is unloaded."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.table_view import CellView


class ForceHysteresis(Page):
    """reading = force + loop * 4 u (1 - u) when unloading, u the place in the range."""

    id, family, stage = "force_hysteresis", "lost_motion", "sensing"
    kinds, places = ("cell",), ("load_cell",)
    inputs = ("load", "direction")
    gives = ("loop",)
    units = {"loop": "N"}
    best = Best("loads", "the same forces with growing and with falling load")
    explanation = (
        "The cell reads more, or less, when it is unloaded than when it was loaded: its spring creeps or slips."
    )
    siblings = {"force_nonlinearity": "both directions alike", "force_drift": "does not come back"}

    def shapes(self, views: Sequence[CellView], site: str) -> list[Shape]:
        """Return one shape, where forces were reached from both sides."""
        return [{}] if np.ptp(views[0].unloading) > 0.0 else []

    def signature(self, view: CellView, site: str, shape: Shape) -> Signature:
        """Return one column: a bow over the range, when unloading."""
        return Signature({Channel(self.stage, site): column(4.0 * view.share * (1.0 - view.share) * view.unloading)})
