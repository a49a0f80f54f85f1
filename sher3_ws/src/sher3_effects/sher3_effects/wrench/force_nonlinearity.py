"""Force nonlinearity: the curve of a load cell is bent."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.table_view import CellView


class ForceNonlinearity(Page):
    """reading = force + a curve of second or third order, alike at both ends of the range and zero at no load."""

    id, family, stage = "force_nonlinearity", "scale", "sensing"
    kinds, places = ("cell",), ("load_cell",)
    inputs = ("load",)
    units = {"largest": "N", "order": "1"}
    discrete = frozenset({"order"})
    best = Best("loads", "five forces or more separate a bent curve from a wrong scale")
    explanation = (
        "The reading bends away from the force in the middle of the range, in both directions of loading alike."
    )
    siblings = {"force_scale": "grows up to the largest force", "force_hysteresis": "shows when unloading only"}

    def shapes(self, views: Sequence[CellView], site: str) -> list[Shape]:
        """Return the orders, 2 and 3, that the number of different forces can tell."""
        forces = len(np.unique(np.round(views[0].share, 2)))
        return [{"order": float(n)} for n in (2, 3) if forces > n + 1]

    def signature(self, view: CellView, site: str, shape: Shape) -> Signature:
        """Return the curves up to an order, one at their largest, off what they are at no load."""
        bent = [x - rest for x, rest in zip(curves(view.share), curves(view.no_load), strict=True)]
        return Signature({Channel(self.stage, site): column(*bent[: round(shape["order"]) - 1])})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the largest deviation of curves (p,) from the line through both ends, with its sign, and the order."""
        bent = np.stack(curves(np.linspace(0.0, 1.0, 101))[: len(coefficients)])
        whole = coefficients @ bent
        return {"largest": float(whole[np.argmax(np.abs(whole))]), "order": shape["order"]}


def curves(share: Array | float) -> list[Array]:
    """Return the curves of second and third order, (g,) each, one at their largest, over the place in the range."""
    bow = np.asarray(share * (1.0 - share))
    return [4.0 * bow, 12.0 * np.sqrt(3.0) * bow * (0.5 - share)]
