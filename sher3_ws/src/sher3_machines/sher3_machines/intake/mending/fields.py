"""Numbers with a sign in the field of one without: a current of -3 that a log shows as 65533, or as 32771."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array

BITS = (16, 32)
"""Lengths of the fields of protocols; a duty of 8 bits goes from 0 to 255 by itself."""
END = 0.25
"""Share of a field, at either end of it, that such numbers lie in."""
FEWEST = 3
"""Different numbers below zero: a switch has one. A sign with a bit of its own changes as often, between as many."""
NEAR_ZERO = 0.05
"""Share of the value of a sign's bit within which the smallest number that has it lies: it goes through zero."""
CLEARER = 0.5
"""Steps through zero over those as recorded, below which the highest bit is a sign."""


def signed(x: Array) -> tuple[Array, str]:
    """Return numbers (n,) with the sign that a field took from them, and how it wrote one; as they are, and "", else.

    A field without a sign has 2^bits - 1 for -1 (two's complement). Others, as those of hobby servos on a bus, keep the
    sign in the highest bit: where it changes, such a number jumps by the value of that bit, and is near zero without.
    """
    known = x[np.isfinite(x)]
    if not len(known) or known.min() < 0.0 or (known != np.round(known)).any() or known.max() < 1.0:
        return x, ""
    for bits in BITS:
        low, high = known < END * 2.0**bits, known >= (1.0 - END) * 2.0**bits
        if known.max() < 2.0**bits and low.any() and (low | high).all() and len(np.unique(known[high])) >= FEWEST:
            return np.where(x >= 0.5 * 2.0**bits, x - 2.0**bits, x), f"{2**bits - 1} for -1, as a field of {bits} bits"
    bit = 2.0 ** np.floor(np.log2(known.max()))
    high, out = known >= bit, np.where(x >= bit, bit - x, x)
    turns = np.flatnonzero(np.diff(high.astype(int)))
    few = min(len(turns), len(np.unique(known[high])), len(np.unique(known[~high]))) < FEWEST
    if few or known[high].min() > (1.0 + NEAR_ZERO) * bit:
        return x, ""
    through = np.abs(np.diff(np.where(high, bit - known, known)))[turns].sum()
    if through > CLEARER * np.abs(np.diff(known))[turns].sum():
        return x, ""
    return out, f"{bit + 1:.0f} for -1, as a field with a bit for the sign"
