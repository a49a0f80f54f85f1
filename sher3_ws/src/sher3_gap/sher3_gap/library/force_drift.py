"""Force drift: the sensor wanders with temperature."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class ForceDrift(LibraryEffect):
    """reading = wrench + coefficient * (T - 22 deg C), per component."""

    id, family, stage = "force_drift", "drift", "sensing"
    explanation = "The force sensor's zero moves with the temperature: nothing at 22 deg C, more the warmer it gets."
    siblings = {"force_bias": "does not change with temperature"}
    units = {"coefficient": "N/K", "fx": "N/K", "fy": "N/K", "fz": "N/K", "tx": "N*m/K", "ty": "N*m/K", "tz": "N*m/K"}

    def sites(self) -> tuple[str, ...]:
        """The force sensor."""
        return ("force_sensor",)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen in the force sensor's reading."""
        return (Channel("sensing", "force_sensor"),)

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Nothing to search; impossible without a temperature."""
        return [{}] if any(v.warmth.any() for v in views) else []

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Six columns: the warmth."""
        return Signature({Channel("sensing", site): view.warmth[:, None, None] * np.eye(6)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Drift per component, and the largest force."""
        names = ("fx", "fy", "fz", "tx", "ty", "tz")
        return {
            "coefficient": float(np.linalg.norm(coefficients[:3])),
            **{n: float(c) for n, c in zip(names, coefficients, strict=True)},
        }
