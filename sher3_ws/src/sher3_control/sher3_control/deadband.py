"""Continuous dead band: zero motion at zero force, and no step where motion begins."""

from .compiled import compiled


@compiled
def deadband(x: float, width: float) -> float:
    """Return x shortened by `width` towards zero (same unit as x): continuous, odd, monotone, |result| <= |x|."""
    if x > width:
        return x - width
    if x < -width:
        return x + width
    return 0.0
