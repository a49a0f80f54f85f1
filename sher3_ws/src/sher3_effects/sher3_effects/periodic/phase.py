"""Amplitude and phase of a periodic error."""

from __future__ import annotations

from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Shape
from sher3_sim.effect import parameter, set_to


def phase_at_zero(on: str) -> Any:
    """Declare the phase at zero position as a parameter, rad; a little over a whole turn either way is allowed."""
    return parameter("rad", 0.0, -7.0, 7.0, "at zero position", fixed_unit=True, on=on, change=set_to)


def sine_of(shape: Shape, coefficients: Array, order: str = "periods_per_rev") -> dict[str, float]:
    """Return amplitude, order and phase [rad] of A sin(n turn + phase); its quadratures are the first two of (p,)."""
    sine, cosine = float(coefficients[0]), float(coefficients[1])
    amplitude, phase = float(np.hypot(sine, cosine)), float(np.arctan2(cosine, sine))
    return {"amplitude": amplitude, order: shape[order], "phase": phase}
