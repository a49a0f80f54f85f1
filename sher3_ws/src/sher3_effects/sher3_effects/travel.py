"""Travel of an axis over all runs: where on it a law bends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Shape

from sher3_effects.view import AxisView


class Travel(NamedTuple):
    """Middle and half of a travel, m or rad."""

    middle: float
    half: float

    def share(self, position: Array) -> Array:
        """Return positions (n,) [m or rad] over half the travel, -1..1."""
        return (position - self.middle) / self.half


def travel_of(views: Sequence[AxisView], site: str) -> Travel | None:
    """Return the travel of an axis over all runs; None where it stood."""
    ends = [f(v.position[:, v.row(site)]) for v in views for f in (np.min, np.max)]
    low, high = float(min(ends)), float(max(ends))
    return Travel(0.5 * (low + high), 0.5 * (high - low)) if high > low else None


def over_travel(views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
    """Return a shape with the travel of an axis beside its values; none where the axis stood."""
    travel = travel_of(views, site)
    return [{**shape, **travel._asdict()}] if travel else []


def share_of(position: Array, shape: Shape) -> Array:
    """Return positions (n,) [m or rad] over half the travel that a shape holds, -1..1."""
    return Travel(shape["middle"], shape["half"]).share(position)
