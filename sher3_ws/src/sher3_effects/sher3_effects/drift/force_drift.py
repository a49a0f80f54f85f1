"""Force drift: the sensor wanders with temperature."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.drift.warmth import warm, warming
from sher3_effects.page import Page
from sher3_effects.view import AxisView


class ForceDrift(Page):
    """reading = wrench + coefficient * (T - 22 deg C), per component."""

    id, family, stage = "force_drift", "drift", "sensing"
    inputs = ("temperature",)
    seen_at = (("sensing", "force_sensor"),)
    breaks = "force_sensor"
    best = Best("postures", "the same postures again at another temperature separate drift from offset")
    places = ("force_sensor",)
    explanation = "The force sensor's zero moves with the temperature: nothing at 22 deg C, more the warmer it gets."
    siblings = {"force_bias": "does not change with temperature"}
    units = {"coefficient": "N/K", "tx": "N*m/K", "ty": "N*m/K", "tz": "N*m/K"}

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Nothing to search; impossible without a temperature."""
        return [{}] if warm(views) else []

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Six columns: the warmth."""
        return Signature({Channel("sensing", site): view.warmth[:, None, None] * np.eye(6)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the drift (6,) per component [N/K, N m/K], and the size of that of the force [N/K]."""
        names = ("fx", "fy", "fz", "tx", "ty", "tz")
        return {
            "coefficient": float(np.linalg.norm(coefficients[:3])),
            **{n: float(c) for n, c in zip(names, coefficients, strict=True)},
        }


def drift(axis: str, default: float) -> Any:
    """Declare the drift along one axis of the sensor as a parameter."""
    return parameter("N/K", default, -5.0, 5.0, f"drift of the reading along {axis} of {{f}}")


class SensorDrift(Page):
    """A force sensor whose zero wanders with its temperature, or with time where that was not recorded."""

    id, family, stage, best = ForceDrift.id, ForceDrift.family, ForceDrift.stage, ForceDrift.best
    kinds, places = ("sensor",), ForceDrift.places
    inputs = ("temperature", "time")
    gives: ClassVar[tuple[str, ...]] = ("fx", "fy", "fz", "tx", "ty", "tz", "with_time")
    explanation = "The zero of the force sensor wanders during the test, in every orientation alike."
    siblings = {"force_bias": "does not wander"}
    discrete = frozenset({"with_time"})
    units = {n: "N" for n in ("fx", "fy", "fz")} | {n: "N*m" for n in ("tx", "ty", "tz")}

    def shapes(self, views: Sequence[Any], site: str) -> list[Shape]:
        """Return time (1) and, where it was recorded and changes, temperature (0)."""
        return [{"with_time": 1.0}, *([{"with_time": 0.0}] if warming(views) else [])]

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return six columns: the share of the test that has passed, or of the warming."""
        span = float(np.ptp(view.warmth)) or 1.0
        share = view.elapsed if shape["with_time"] else (view.warmth - view.warmth.min()) / span
        return Signature({Channel(self.stage, site): share[:, None, None] * np.eye(6)})


class CellDrift(SensorDrift):
    """The zero of a load cell wanders, with its temperature or with time."""

    kinds, places = ("cell",), ("load_cell",)
    gives = ("over_test", "with_time")
    explanation = "The zero of the load cell wanders during the test, under every force alike."
    units = {"over_test": "N"}

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return one column: the share of the test that has passed, or of the warming."""
        (columns,) = super().signature(view, site, shape).columns.values()
        return Signature({Channel(self.stage, site): column(columns[:, 0, 0])})


@dataclass(frozen=True)
class ForceDriftInPlant(PlantEffect, page=ForceDrift):
    """The force sensor's zero follows the temperature."""

    fx: float = drift("x", 0.0)
    fy: float = drift("y", 0.0)
    fz: float = drift("z", 0.02)

    def apply(self, p: PlantParameters) -> None:
        """Add the drift."""
        p.body["wrench_drift"][0, :3] += (self.fx, self.fy, self.fz)
