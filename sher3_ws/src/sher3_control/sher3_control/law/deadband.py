"""Continuous dead band: no motion at small forces, and no step where motion begins."""

from sher3_common.compiled import compiled


@compiled
def deadband(x: float, width: float) -> float:
    """Return x shortened by `width` towards zero (same unit as x): continuous, odd, monotone, |result| <= |x|."""
    if x > width:
        return x - width
    if x < -width:
        return x + width
    return 0.0
