"""Numbers with a sign in the field of one without: a current of -3 that a log shows as 65533."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array

BITS = (16, 32)
"""Lengths of the fields of protocols; a duty of 8 bits goes from 0 to 255 by itself."""
END = 0.25
"""Share of a field, at either end of it, that such numbers lie in."""
FEWEST = 3
"""Different numbers at the upper end: a switch has one."""


def unsigned_bits(x: Array) -> int:
    """Return the bits of the field that numbers (n,) with a sign were written into without it; 0 for none."""
    known = x[np.isfinite(x)]
    if not len(known) or known.min() < 0.0 or (known != np.round(known)).any():
        return 0
    for bits in BITS:
        low, high = known < END * 2.0**bits, known >= (1.0 - END) * 2.0**bits
        if known.max() < 2.0**bits and low.any() and (low | high).all() and len(np.unique(known[high])) >= FEWEST:
            return bits
    return 0


def signed(x: Array, bits: int) -> Array:
    """Return numbers (n,) with the sign that a field of so many bits took from them."""
    return np.where(x >= 0.5 * 2.0**bits, x - 2.0**bits, x)
