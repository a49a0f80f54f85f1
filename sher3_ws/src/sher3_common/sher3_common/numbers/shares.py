"""How sure a share of a number of cases is."""

from __future__ import annotations

import math

Z = 1.959963984540054
"""Half width of a normal distribution's 95 % interval in standard deviations."""


def wilson(share: float, n: int) -> tuple[float, float]:
    """Return the 95 % Wilson score interval of a share of `n` cases, n > 0 (Wilson 1927)."""
    centre = (share + Z * Z / (2 * n)) / (1 + Z * Z / n)
    half = Z / (1 + Z * Z / n) * math.sqrt(share * (1 - share) / n + Z * Z / (4 * n * n))
    return max(0.0, centre - half), min(1.0, centre + half)
