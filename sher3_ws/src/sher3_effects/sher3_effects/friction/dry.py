"""Dry friction at rest: it holds whatever is needed up to its level, which no history of the motion tells."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.view import AxisView

STILL = 0.1
"""Time in which an axis at rest moves by less than one count of its encoder, s."""


class DryFriction(Page):
    """A friction with a level: in sliding it is the level, at rest any force up to the level.

    Coulomb's inequality: how a bristle bends below the resolution of the encoders is not recorded. On other machines
    the balance at rest is a rule of its own (`sher3_chain.axes.causes.balance_at_rest`).
    """

    DISPLACEMENTS: ClassVar[tuple[float, ...]] = ()
    """Displacements over which the force turns round after a reversal, in motor revolutions."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return the displacements over which the force turns round, m or rad."""
        return [{"displacement": d * views[0].lead(site)} for d in self.DISPLACEMENTS]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return one column: the Dahl state."""
        z = view.run.to_grid(view.sliding(view.row(site), shape["displacement"]))
        return Signature({Channel(self.stage, site): column(z)})

    def held(self, view: AxisView, site: str, shape: Shape, coefficients: Array) -> Array | None:
        """Return the level (g,) where an axis rests, 0 where it moves; None if no count is known."""
        count = view.axis(site).seen
        if not view.holds_at_rest or count == 0.0:
            return None
        rests = np.abs(view.velocity[:, view.row(site)]) < count / STILL
        forward: Any = _Slid(view)
        columns = self.signature(forward, site, shape).columns[Channel(self.stage, site)]
        return np.where(rests, np.abs(columns[:, 0] @ coefficients), 0.0)


class _Slid:
    """A view of which every axis has slid forward: what a friction adds there is its level."""

    def __init__(self, view: AxisView) -> None:
        self._view = view

    def __getattr__(self, name: str) -> Any:
        return getattr(self._view, name)

    def sliding(self, axis: int, displacement: float) -> Array:
        """Return the state of a friction that has slid forward, (n,)."""
        return np.ones(self._view.run.ticks)
