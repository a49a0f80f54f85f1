"""Position error map: what a table deviates by at each target, beyond a straight line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature

from sher3_effects.page import Page
from sher3_effects.table_view import TableView


class PositionErrorMap(Page):
    """deviation = a broken line over the target, whose ends and slope are those of other effects."""

    id, family, stage = "position_error_map", "geometry", "transmission"
    kinds, places = ("table",), ("axis",)
    inputs = ("position",)
    units = {"range": "m", "largest_target": "1"}
    discrete = frozenset({"largest_target"})
    best = Best("postures", "more targets separate a map from a wave")
    explanation = "The axis deviates at some targets and not at others, in every cycle alike: guide, scale or screw."
    siblings = {"transmission_ripple": "a wave of one period", "lead_error": "a straight line"}
    extends = ("transmission_ripple",)
    LEAST = 4
    """Targets from which a broken line is more than a straight one."""

    def shapes(self, views: Sequence[TableView], site: str) -> list[Shape]:
        """Return one shape where there are targets enough."""
        return [{}] if len(views[0].nodes) >= self.LEAST else []

    def signature(self, view: TableView, site: str, shape: Shape) -> Signature:
        """Return one column for each inner target: a hat over it."""
        hats = [np.interp(view.target, view.nodes, hat) for hat in np.eye(len(view.nodes))[1:-1]]
        return Signature({Channel(self.stage, site): np.stack(hats, axis=-1)[:, None, :]})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the range of the map, and the number of the target at which it is largest."""
        whole = np.concatenate([[0.0], coefficients, [0.0]])
        return {"range": float(np.ptp(whole)), "largest_target": float(np.argmax(np.abs(whole)) + 1)}
