"""Counters that start again: angles within one turn, and fields of a protocol that hold so much and no more.

A servo that sends its angle as 16 bits over 25 rad jumps by 25 rad where it would leave that range. An axis that moves
on in one sense before and after a jump of the whole range against it did not come back: its counter began again.
"""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array

TURN = 2.0 * np.pi
"""A turn, rad."""
WRAP = 0.1
"""Share of a range by which a jump between two samples may differ from it: what an axis moves by in a sample."""
FEW = 0.01
"""Share of readings at either end that may be wrong ones: they do not tell how far an angle goes."""
ALIKE = 0.02
"""Share of a range by which jumps over it may differ."""
ROUND = 0.005
"""Share by which a range found in jumps may miss the round one: the axis speeds up or slows down in between."""


def wrapped_over(x: Array, step: float, rotary: bool) -> float:
    """Return the range after which a place (n,) starts again, m or rad; 0 where it does not.

    Args:
        x: as recorded.
        step: one count of its encoder: fields of a protocol hold a power of two of counts.
        rotary: whether it is an angle, of which jumps by a turn are wraps whatever it does before and after; what goes
            further than a turn does not start again there.
    """
    steps = np.diff(x)
    most = np.ptp(np.quantile(x, (FEW, 1.0 - FEW)))
    if rotary and most < (1.0 + WRAP) * TURN and (np.abs(np.abs(steps) - TURN) < WRAP * TURN).any():
        return TURN
    at = np.flatnonzero(np.abs(steps) > (1.0 - WRAP) * np.ptp(x))
    at = at[(at > 0) & (at < len(steps) - 1)]
    before, jump, after = steps[at - 1], steps[at], steps[at + 1]
    way = 0.5 * (before + after)
    clear = (before * after > 0.0) & (way * jump < 0.0) & (np.abs(way) < WRAP * np.abs(jump))
    if not clear.any():
        return 0.0
    found = np.abs(jump - way)[clear]
    middle = float(np.median(found))
    return _round(middle, step, rotary) if np.ptp(found) < ALIKE * middle else 0.0


def joined(x: Array, over: float) -> tuple[Array, int]:
    """Return a place (n,) without its wraps over a range, and how many they were."""
    return np.unwrap(x, period=over), int((np.abs(np.diff(x)) > 0.5 * over).sum())


def _round(found: float, step: float, rotary: bool) -> float:
    """Return the round range next to the one found: a power of two of counts, turns, or two digits; else itself."""
    digit = 10.0 ** (np.floor(np.log10(found)) - 1.0)
    near = [round(found / digit) * digit]
    near += [2.0 ** round(np.log2(found / step)) * step] if step > 0.0 else []
    near += [round(found / TURN) * TURN] if rotary else []
    best = min(near, key=lambda x: abs(x - found))
    return float(best) if abs(best - found) < ROUND * found else found
