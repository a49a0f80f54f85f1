"""Readings of a load cell as effects and engine see them; they are no course in time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.evidence import Motion


@dataclass(frozen=True, eq=False)
class ForcesView:
    """All readings of a cell.

    Attributes:
        applied: (g,) known force, N or N m.
        unloading: (g,) 1 where it was reached from a larger one, else 0.
        warmth: (g,) temperature above the first reading's, K; zero where it was not recorded.
    """

    applied: Array
    unloading: Array
    warmth: Array

    @cached_property
    def share(self) -> Array:
        """(g,) place of the force between the least and the largest one."""
        return (self.applied - self.applied.min()) / float(np.ptp(self.applied))

    @property
    def elapsed(self) -> Array:
        """(g,) share of the test that had passed."""
        return np.linspace(0.0, 1.0, len(self.applied))

    @property
    def excitation(self) -> str:
        """Name of what was recorded."""
        return "forces"

    @property
    def rate(self) -> None:
        """None: readings are no course in time."""

    @property
    def loaded(self) -> Mask:
        """(g,) False: nothing acts beside the known force."""
        return np.zeros(len(self.applied), dtype=bool)

    @property
    def temperature_known(self) -> bool:
        """Whether the temperature changed."""
        return bool(self.warmth.any())

    @property
    def speed_share(self) -> Array:
        """(g,) zero: the cell is at rest."""
        return np.zeros(len(self.applied))

    def motion(self, actuator: str) -> Motion | None:
        """Return None: nothing moves."""
        return None

    def inputs(self, actuator: str) -> Array:
        """Return force, direction, warmth and order (g, 4)."""
        return np.column_stack([self.applied, self.unloading, self.warmth, self.elapsed])
