"""Position error map: what a table deviates by at each target, beyond a straight line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature

from sher3_effects.page import Page
from sher3_effects.table_view import TableView

BEST_LINE = "best_line"
"""Name of the shape that departs from the line that fits best, not from the one through both ends."""


class PositionErrorMap(Page):
    """deviation = a broken line over the target, whose offset and slope are those of other effects.

    Where its slope is zero is a matter of the machine: a bump leaves both ends alone, a bent guide has no end of its
    own. So the line it departs from runs through its ends, or is the one that fits its targets best.
    """

    id, family, stage = "position_error_map", "geometry", "transmission"
    kinds, places = ("table",), ("axis",)
    inputs = ("position",)
    units = {"range": "m", "largest_target": "1"}
    discrete = frozenset({"largest_target"})
    best = Best("postures", "more targets separate a map from a wave")
    explanation = "The axis deviates at some targets and not at others, in every cycle alike: guide, scale or screw."
    siblings = {"transmission_ripple": "a wave of one period", "lead_error": "a straight line"}
    extends = ("transmission_ripple",)
    bent_from = 0.0
    LEAST = 4
    """Targets from which a broken line is more than a straight one."""

    def shapes(self, views: Sequence[TableView], site: str) -> list[Shape]:
        """Return one shape where there are targets enough."""
        return [{}] if len(views[0].nodes) >= self.LEAST else []

    def bends(self, views: Sequence[TableView], site: str, shape: Shape) -> list[Shape]:
        """Return the map that departs from the line that fits best."""
        return [{BEST_LINE: 1.0}]

    def signature(self, view: TableView, site: str, shape: Shape) -> Signature:
        """Return one column for each target but two: broken lines without an offset and a slope over the targets."""
        nodes = view.nodes
        bent = bent_lines(len(nodes) - 2, shape)
        if BEST_LINE in shape:
            line = np.column_stack([np.ones(len(nodes)), nodes])
            bent = bent - line @ np.linalg.lstsq(line, bent, rcond=None)[0]
        columns = [np.interp(view.target, nodes, x) for x in bent.T]
        return Signature({Channel(self.stage, site): np.stack(columns, axis=-1)[:, None, :]})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the range of the map of (p,), and the number of the target at which it is largest."""
        whole = bent_lines(len(coefficients), shape) @ coefficients
        return {"range": float(np.ptp(whole)), "largest_target": float(np.argmax(np.abs(whole)) + 1)}


def bent_lines(bends: int, shape: Shape) -> Array:
    """Return a basis (bends + 2, bends) of what is zero at both ends, or has no offset and slope over even targets."""
    count = np.arange(bends + 2.0)
    if BEST_LINE not in shape:
        return np.eye(bends + 2)[:, 1:-1]
    return np.linalg.svd(np.column_stack([np.ones(bends + 2), count - count.mean()]))[0][:, 2:]
