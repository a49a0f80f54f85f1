"""Axis locks: which part of a tip twist in {t} passes."""

from enum import IntEnum

from sher3_common.compiled import compiled
from sher3_common.vectors import Twist


class AxisLock(IntEnum):
    """What the tip may do. The numbers are recorded, so they never change.

    FREE: everything. TRANSLATE: linear motion only. ROTATE: rotation about the tip only. NEEDLE: motion along the
    needle (z of {t}) only.
    """

    FREE = 0
    TRANSLATE = 1
    ROTATE = 2
    NEEDLE = 3


@compiled
def apply_lock(twist: Twist, lock: int) -> Twist:
    """Return the part of a tip twist in {t} that `lock`, an `AxisLock`, lets through."""
    x, y, z, u, v, w = twist
    if lock == AxisLock.TRANSLATE:
        return (x, y, z, 0.0, 0.0, 0.0)
    if lock == AxisLock.ROTATE:
        return (0.0, 0.0, 0.0, u, v, w)
    if lock == AxisLock.NEEDLE:
        return (0.0, 0.0, z, 0.0, 0.0, 0.0)
    return twist
