"""What the engine reads of every table: rows at rest are no course in time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.evidence import Motion


@dataclass(frozen=True, eq=False)
class Still:
    """Rows without a clock; a kind of table adds what its effects ask for.

    Class attributes:
        excitation: name of what was recorded.
        rate: None, rows are no course in time.
        by_temperature: whether a regime may be named after the temperature.

    Attributes:
        warmth: (g,) temperature above the reference, K; zero where it was not recorded.
    """

    excitation = "readings"
    rate = None
    by_temperature = True
    warmth: Array

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.warmth)

    @property
    def temperature_known(self) -> bool:
        """Whether the temperature changed."""
        return self.by_temperature and bool(self.warmth.any())

    @property
    def loaded(self) -> Mask:
        """(g,) False: nothing acts beside what is known."""
        return np.zeros(self.rows, dtype=bool)

    @property
    def speed_share(self) -> Array:
        """(g,) zero: the machine is at rest when it is measured."""
        return np.zeros(self.rows)

    @property
    def elapsed(self) -> Array:
        """(g,) share of the test that had passed."""
        return np.linspace(0.0, 1.0, self.rows)

    def motion(self, actuator: str) -> Motion | None:
        """Return None: nothing moves."""
        return None

    def inputs(self, actuator: str) -> Array:
        """Return (g, k) quantities a static law could depend on; each kind says them."""
        raise NotImplementedError
