"""Readings of a load cell as effects see them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_static.view import Still


@dataclass(frozen=True, eq=False)
class ForcesView(Still):
    """All readings of a cell.

    Attributes:
        applied: (g,) known force, N or N m.
        unloading: (g,) 1 where it was reached from a larger one, else 0.
    """

    excitation = "forces"
    applied: Array
    unloading: Array

    @cached_property
    def share(self) -> Array:
        """(g,) place of the force between the least and the largest force."""
        return (self.applied - self.applied.min()) / float(np.ptp(self.applied))

    def inputs(self, actuator: str) -> Array:
        """Return force, direction, warmth and order (g, 4)."""
        return np.column_stack([self.applied, self.unloading, self.warmth, self.elapsed])
