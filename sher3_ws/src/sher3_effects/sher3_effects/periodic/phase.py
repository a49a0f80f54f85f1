"""Amplitude, phase and orders of a periodic error."""

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


def orders_of(shape: Shape) -> list[float]:
    """Return the orders of a shape, its number of teeth first.

    Teeth that differ over a revolution are a sine whose amplitude goes round, once where the wheel is off its centre,
    twice where it is oval and three times where it sits on three screws: neighbours up to three off show. The shape of
    one tooth is a second and third harmonic.
    """
    n = shape["periods_per_rev"]
    beside = (n - 1.0, n + 1.0, n - 2.0, n + 2.0, n - 3.0, n + 3.0, 2.0 * n, 3.0 * n) if shape.get("unlike") else ()
    return list(dict.fromkeys([n, *(k for k in beside if k > 0.0)]))
