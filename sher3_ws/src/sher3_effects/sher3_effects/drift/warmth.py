"""Whether recorded temperatures tell anything: a reading that differs by rounding alone is no warmth."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from sher3_diagnosis.channel import Array

LEAST_WARMTH = 0.01
"""Temperature from which there is one, K: the resolution of a good thermometer. A line through constant readings of
22 deg C is off by 4e-15 K on one processor and by nothing on another."""


class Warm(Protocol):
    """What tells its warmth."""

    @property
    def warmth(self) -> Array:
        """(g,) temperature above the reference, K."""


def warm(views: Sequence[Warm]) -> bool:
    """Return whether any run was at another temperature than the reference."""
    return any(float(np.max(np.abs(v.warmth), initial=0.0)) > LEAST_WARMTH for v in views)


def warming(views: Sequence[Warm]) -> bool:
    """Return whether the temperature changed within any run."""
    return any(float(np.ptp(v.warmth)) > LEAST_WARMTH for v in views)
