"""Transmission ripple: the load runs ahead and behind periodically."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column, lead


class TransmissionRipple(LibraryEffect):
    """load = motor + A sin(2 pi n q / lead + phase)."""

    id, family, stage = "transmission_ripple", "periodic", "transmission"
    explanation = (
        "The load moves ahead and behind the motor, n times per lead; the load encoder sees it and the tip follows."
    )
    siblings = {
        "encoder_eccentricity": "only the reading swings, the tip does not",
        "cogging": "a force, not a displacement",
    }
    units = {"amplitude": "m", "periods_per_rev": "1", "phase": "rad"}
    ORDERS = (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 14, 16, 18, 20)

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Periods per lead."""
        return [{"periods_per_rev": float(n), "side": 0.0} for n in self.ORDERS]

    def refine(self, shape: Shape) -> list[Shape]:
        """Add a second order: the first, a neighbour (side-band), or a harmonic."""
        n = shape["periods_per_rev"]
        sides = {1.0, n - 1.0, n + 1.0, 2.0 * n, 3.0 * n} - {0.0, n}
        return [{**shape, "side": s} for s in sorted(sides)]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Two columns per order: the quadratures."""
        axis = axis_of(site)
        turn = 2.0 * np.pi * view.run.smooth[:, axis] / lead(view, site)
        orders = [shape["periods_per_rev"], *([shape["side"]] if shape["side"] else [])]
        waves = [view.run.to_grid(f(n * turn)) for n in orders for f in (np.sin, np.cos)]
        return Signature({Channel(self.stage, site): column(*waves)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Amplitude, order and phase."""
        return {
            "amplitude": float(np.hypot(coefficients[0], coefficients[1])),
            "periods_per_rev": shape["periods_per_rev"],
            "phase": float(np.arctan2(coefficients[1], coefficients[0])),
        }
