"""Cogging: a force that repeats with the motor angle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column, lead


class Cogging(LibraryEffect):
    """F = A sin(2 pi n q / lead + phase)."""

    id, family, stage = "cogging", "periodic", "motor_mechanics"
    explanation = (
        "A force that repeats several times per motor revolution, the same in both directions and at every speed."
    )
    siblings = {
        "position_friction": "the sign follows the direction of motion",
        "transmission_ripple": "the load moves, no force is needed",
    }
    units = {"amplitude": "N", "periods_per_rev": "1", "phase": "rad"}
    ORDERS = (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 16, 18, 20, 22, 24)

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Periods per motor revolution."""
        return [{"periods_per_rev": float(n)} for n in self.ORDERS]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Two columns: the quadratures, low-passed as the residual is."""
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
