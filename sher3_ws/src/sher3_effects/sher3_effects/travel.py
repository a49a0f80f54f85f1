"""Travel of an axis over all runs: where on it a law bends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_effects.view import AxisView


class Travel(NamedTuple):
    """Middle and half of a travel, m or rad."""

    middle: float
    half: float

    def share(self, position: Array) -> Array:
        """Return positions over half the travel, -1..1."""
        return (position - self.middle) / self.half


def travel_of(views: Sequence[AxisView], site: str) -> Travel | None:
    """Return the travel of an axis over all runs; None where it stood."""
    ends = [f(v.position[:, v.row(site)]) for v in views for f in (np.min, np.max)]
    low, high = float(min(ends)), float(max(ends))
    return Travel(0.5 * (low + high), 0.5 * (high - low)) if high > low else None
