"""Structural vibration: the arm rings after fast moves and load steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.operators import oscillator
from sher3_effects.page import TIP_POSE, Page
from sher3_effects.view import RobotView


class StructuralVibration(Page):
    """The tip rides on a lightly damped spring-mass that its own acceleration shakes."""

    id, family, stage = "structural_vibration", "compliance", "structure"
    inputs = ("acceleration",)
    seen_at = TIP_POSE
    best = Best("loads", "known loads in several postures separate springs")
    places = ("tip",)
    leaves_out = "further modes"
    explanation = "After each acceleration the tip rings at one frequency while the encoders are still."
    siblings = {"structural_compliance": "follows a static load without ringing"}
    FREQUENCIES = (4.0, 5.0, 6.3, 8.0, 10.0, 12.5, 15.0, 17.5, 20.0, 22.5, 25.0, 28.0, 31.0, 34.0, 38.0, 42.0, 46.0)
    finer = {"frequency": (0.9, 0.94, 0.97, 0.985, 0.993, 1.007, 1.015, 1.03, 1.06, 1.1), "damping": (0.5, 0.75, 1.7)}
    discrete = frozenset({"single"})
    PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    """Axes of {b} that a column couples."""

    ONE_MODE = 0.5
    """Second principal value of the matrix over the first from which it is no single mode: half way to two alike."""

    def shapes(self, views: Sequence[RobotView], site: str) -> list[Shape]:
        """Frequency, damping, and whether each axis swings by itself (0) or one mode in one direction (1)."""
        return [
            {"frequency": f, "damping": z, "single": s}
            for f in self.FREQUENCIES
            for z in (0.02, 0.08)
            for s in (0.0, 1.0)
        ]

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """Three columns, the motion along x, y, z of {b}; of one mode six, the entries of its symmetric matrix."""
        if view.run.tracker_position is None:
            return Signature()
        scale = (2.0 * np.pi * shape["frequency"]) ** 2
        motion = oscillator(-view.tip_acceleration / scale, shape["frequency"], shape["damping"], view.run.period)[
            view.run.grid
        ]
        pairs = self.PAIRS if shape["single"] else self.PAIRS[:3]
        columns = np.zeros((len(motion), 6, len(pairs)))
        for k, (i, j) in enumerate(pairs):
            columns[:, i, k] = motion[:, j]
            columns[:, j, k] = motion[:, i]
        return Signature(view.at_tip(columns))

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Frequency, damping, and participation with its direction: of one mode the principal one of its matrix.

        Coefficients: (3,) along x, y, z of {b}; of one mode (6,), the entries of its matrix as `PAIRS` has them.
        """
        if shape["single"]:
            matrix = np.zeros((3, 3))
            for (i, j), c in zip(self.PAIRS, coefficients, strict=True):
                matrix[i, j] = matrix[j, i] = c
            values, vectors = np.linalg.eigh(matrix)
            largest, second = np.argsort(-np.abs(values))[:2]
            if abs(values[second]) > self.ONE_MODE * abs(values[largest]):
                # Several modes of one frequency: what swings is each axis by itself.
                return self.parameters({**shape, "single": 0.0}, np.diag(matrix))
            amplitude, direction = float(values[largest]), vectors[:, largest]
            direction = direction * np.sign(direction[np.argmax(np.abs(direction))])
            return {**shape, "amplitude": amplitude, **dict(zip("xyz", direction.tolist(), strict=True))}
        amplitude = float(np.linalg.norm(coefficients))
        direction = coefficients / amplitude if amplitude > 0.0 else np.zeros(3)
        return {**shape, "amplitude": amplitude, **dict(zip("xyz", direction.tolist(), strict=True))}


@dataclass(frozen=True)
class StructuralVibrationInPlant(PlantEffect, page=StructuralVibration):
    """The arm swings at its own frequency when the tip is accelerated."""

    frequency: float = parameter("Hz", 25.0, 1.0, 200.0, "of the undamped mode")
    damping: float = parameter("1", 0.03, 1e-3, 0.9, "damping ratio")
    amplitude: float = parameter("1", 1.0, 0.0, 20.0, "deflection per static deflection under the tip's acceleration")
    x: float = parameter("1", 1.0, -1.0, 1.0, "share of the amplitude along x of {b}")
    y: float = parameter("1", 1.0, -1.0, 1.0, "share of the amplitude along y of {b}")
    z: float = parameter("1", 1.0, -1.0, 1.0, "share of the amplitude along z of {b}")
    single: float = parameter("1", 0.0, 0.0, 1.0, "0: each axis by itself; 1: one mode along (x, y, z)")

    def apply(self, p: PlantParameters) -> None:
        """Add the mode."""
        p.body["mode_frequency"] = self.frequency
        p.body["mode_damping"] = self.damping
        share = np.array([self.x, self.y, self.z])
        p.body["mode_gain"][0] = self.amplitude * (np.outer(share, share) if round(self.single) else np.diag(share))
