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
        return [{"periods_per_rev": float(n)} for n in self.ORDERS]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Two columns: the quadratures."""
        axis = axis_of(site)
        phase = 2.0 * np.pi * shape["periods_per_rev"] * view.run.smooth[:, axis] / lead(view, site)
        return Signature(
            {Channel(self.stage, site): column(view.run.to_grid(np.sin(phase)), view.run.to_grid(np.cos(phase)))}
        )

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Amplitude, order and phase."""
        return {
            "amplitude": float(np.hypot(*coefficients)),
            "periods_per_rev": shape["periods_per_rev"],
            "phase": float(np.arctan2(coefficients[1], coefficients[0])),
        }
