"""Axis locks: which part of a tip twist in {t} is let through."""

from enum import IntEnum

from .compiled import compiled
from .limits import Twist


class AxisLock(IntEnum):
    """`FREE` moves everything; the numbers are recorded, so they never change."""

    FREE = 0
    TRANSLATE = 1
    ROTATE = 2
    NEEDLE = 3


@compiled
def apply_lock(twist: Twist, lock: int) -> Twist:
    """Project a tip twist in {t}: translation, rotation about the tip, or motion along the needle (z of {t}) only."""
    x, y, z, u, v, w = twist
    if lock == AxisLock.TRANSLATE:
        return (x, y, z, 0.0, 0.0, 0.0)
    if lock == AxisLock.ROTATE:
        return (0.0, 0.0, 0.0, u, v, w)
    if lock == AxisLock.NEEDLE:
        return (0.0, 0.0, z, 0.0, 0.0, 0.0)
    return twist
