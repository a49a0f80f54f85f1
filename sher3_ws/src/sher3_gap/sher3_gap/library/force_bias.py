"""Force bias: the sensor reads a constant at no load."""

from __future__ import annotations

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class ForceBias(LibraryEffect):
    """reading = wrench + (fx, fy, fz, tx, ty, tz)."""

    id, family, stage = "force_bias", "wrench", "sensing"
    explanation = "The force sensor is off by a constant in its own frame, in every pose and under every load."
    siblings = {"tool_gravity": "turns with roll and tilt", "force_drift": "grows with temperature"}
    units = {"fx": "N", "fy": "N", "fz": "N", "tx": "N*m", "ty": "N*m", "tz": "N*m"}

    def sites(self) -> tuple[str, ...]:
        """The force sensor."""
        return ("force_sensor",)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen in the force sensor's reading."""
        return (Channel("sensing", "force_sensor"),)

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Six columns of ones."""
        return Signature({Channel("sensing", site): np.tile(np.eye(6), (len(view.run.grid), 1, 1))})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Bias per component."""
        return {n: float(c) for n, c in zip(self.units, coefficients, strict=True)}
