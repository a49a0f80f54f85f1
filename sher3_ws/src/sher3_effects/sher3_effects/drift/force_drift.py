"""Force drift: the sensor wanders with temperature."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.page import Page
from sher3_effects.view import AxisView


class ForceDrift(Page):
    """reading = wrench + coefficient * (T - 22 deg C), per component."""

    id, family, stage = "force_drift", "drift", "sensing"
    inputs = ("temperature",)
    breaks = "force_sensor"
    best = Best("postures", "the same postures again at another temperature separate drift from offset")
    places = ("force_sensor",)
    explanation = "The force sensor's zero moves with the temperature: nothing at 22 deg C, more the warmer it gets."
    siblings = {"force_bias": "does not change with temperature"}
    units = {"coefficient": "N/K", "tx": "N*m/K", "ty": "N*m/K", "tz": "N*m/K"}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return the reading of the force sensor."""
        return (Channel("sensing", "force_sensor"),)

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Nothing to search; impossible without a temperature."""
        return [{}] if any(v.warmth.any() for v in views) else []

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Six columns: the warmth."""
        return Signature({Channel("sensing", site): view.warmth[:, None, None] * np.eye(6)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Drift per component, and the largest force."""
        names = ("fx", "fy", "fz", "tx", "ty", "tz")
        return {
            "coefficient": float(np.linalg.norm(coefficients[:3])),
            **{n: float(c) for n, c in zip(names, coefficients, strict=True)},
        }


def drift(axis: str, default: float) -> Any:
    """Declare the drift along one axis of the sensor as a parameter."""
    return parameter("N/K", default, -5.0, 5.0, f"drift of the reading along {axis} of {{f}}")


@dataclass(frozen=True)
class ForceDriftInPlant(PlantEffect, page=ForceDrift):
    """The force sensor's zero follows the temperature."""

    fx: float = drift("x", 0.0)
    fy: float = drift("y", 0.0)
    fz: float = drift("z", 0.02)

    def apply(self, p: PlantParameters) -> None:
        """Add the drift."""
        p.body["wrench_drift"][0, :3] += (self.fx, self.fy, self.fz)
