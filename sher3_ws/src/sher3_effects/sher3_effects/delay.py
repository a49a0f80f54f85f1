"""A recording that comes late: how it is shifted, and when it is late no more but of another moment."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array

LONGEST_DELAY = 0.25
"""Delay, s, beyond which two recordings are not of the same moment at all."""


def shifted(x: Array, clock: Array, delay: float) -> Array:
    """Return x (n,) as it was `delay` ago, s; its ends stay as they are."""
    return np.interp(clock - delay, clock, x)
