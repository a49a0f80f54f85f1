"""The phase of a periodic error."""

from __future__ import annotations

from typing import Any

from sher3_sim.effect import parameter


def phase_at_zero() -> Any:
    """Declare the phase at zero position as a parameter, rad; a little over a whole turn either way is allowed."""
    return parameter("rad", 0.0, -7.0, 7.0, "at zero position", fixed_unit=True)
