"""Structural vibration: the arm rings after fast moves and load steps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View
from sher3_gap.library.operators import oscillator


class StructuralVibration(LibraryEffect):
    """The tip rides on a lightly damped spring-mass that its own acceleration shakes."""

    id, family, stage = "structural_vibration", "compliance", "structure"
    explanation = "After each acceleration the tip rings at one frequency while the encoders are still."
    siblings = {"structural_compliance": "follows a static load without ringing"}
    units = {"frequency": "Hz", "damping": "1", "amplitude": "1", "x": "1", "y": "1", "z": "1"}
    FREQUENCIES = (4.0, 5.0, 6.3, 8.0, 10.0, 12.5, 15.0, 17.5, 20.0, 22.5, 25.0, 28.0, 31.0, 34.0, 38.0, 42.0, 46.0)

    def sites(self) -> tuple[str, ...]:
        """The tip."""
        return ("tip",)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen at the tip, loaded or not."""
        return (Channel("mechanism", "tip"), Channel("structure", "tip"))

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Frequency and damping."""
        return [{"frequency": f, "damping": z} for f in self.FREQUENCIES for z in (0.02, 0.08)]

    def refine(self, shape: Shape) -> list[Shape]:
        """Between the neighbours."""
        near = [
            {**shape, "frequency": shape["frequency"] * f} for f in (0.9, 0.94, 0.97, 0.985, 1.015, 1.03, 1.06, 1.1)
        ]
        return [*near, {**shape, "damping": shape["damping"] * 0.5}, {**shape, "damping": shape["damping"] * 1.7}]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Three columns: the relative motion along x, y, z of {b}."""
        if view.run.tracker_position is None:
            return Signature()
        scale = (2.0 * np.pi * shape["frequency"]) ** 2
        motion = oscillator(-view.tip_acceleration / scale, shape["frequency"], shape["damping"], view.run.period)[
            view.run.grid
        ]
        columns = np.zeros((len(motion), 6, 3))
        for a in range(3):
            columns[:, a, a] = motion[:, a]
        return Signature(view.at_tip(columns))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Frequency, damping, and participation with its direction."""
        amplitude = float(np.linalg.norm(coefficients))
        direction = coefficients / amplitude if amplitude > 0.0 else np.zeros(3)
        return {**shape, "amplitude": amplitude, **dict(zip("xyz", direction.tolist(), strict=True))}
