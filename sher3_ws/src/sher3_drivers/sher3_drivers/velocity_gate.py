"""What velocity command may pass to the drives: five finite numbers within the velocity limits."""

from __future__ import annotations

from collections.abc import Sequence

from .errors import CommandRefused
from .units import AxisScale


def velocity_counts(scales: Sequence[AxisScale], velocity: Sequence[float]) -> list[int]:
    """Return a velocity command (5,) [m/s, rad/s] in the drives' counts.

    Raises:
        CommandRefused: not five values, not finite, or beyond a velocity limit.
    """
    if len(velocity) != len(scales):
        what = "number of velocities"
        raise CommandRefused(what, value=len(velocity), limit=len(scales), remedy="send five")
    counts = []
    for scale, value in zip(scales, velocity, strict=True):
        if not abs(value) <= scale.velocity_limit * (1.0 + 1e-9):  # a NaN compares false
            what, remedy = f"{scale.name}: velocity command", "limit it at its source"
            raise CommandRefused(what, value=value, limit=scale.velocity_limit, remedy=remedy)
        # Within the limit, which `AxisScale` has made sure fits the object.
        counts.append(round(value / scale.velocity))
    return counts
