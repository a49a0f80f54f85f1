"""Force cross-talk: a load on one axis shows on another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from sher3_description import Robot
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.page import Page, Part, Tolerated, Values
from sher3_effects.view import AxisView


class ForceCrosstalk(Page):
    """reading_i += coefficient * wrench_j, i != j: one pair of forces, all of them, or all of forces and moments."""

    id, family, stage = "force_crosstalk", "wrench", "sensing"
    kinds: ClassVar[tuple[str, ...]] = ("robot",)
    inputs = ("load",)
    seen_at = (("sensing", "force_sensor"),)
    breaks = "force_sensor"
    best = Best("loads", "known loads in several orientations separate bias, weight and cross-talk")
    places = ("force_sensor",)
    discrete = frozenset({"source", "target"})
    NAMES = {-1.0: "every force", -2.0: "every component", 0.0: "x", 1.0: "y", 2.0: "z"}
    choices = {"source": NAMES, "target": NAMES}
    explanation = "A force along one axis of the sensor shows up on another axis, in proportion."
    siblings = {"force_scale": "on the same axis", "tool_gravity": "there without a load on the tip"}
    FORCES = tuple((j, i) for j in range(3) for i in range(3) if i != j)
    PAIRS = tuple("xyz"[i] + "xyz"[j] for j, i in FORCES)
    EVERY = FORCES + tuple((j, i) for j in range(6) for i in range(6) if i != j and max(i, j) > 2)
    """Pairs (source, target) of forces, then those with moments."""
    SEVERAL: ClassVar[tuple[float, ...]] = (-1.0, -2.0)
    """Every pair of forces (-1), and every pair of forces and moments (-2)."""
    units = {"coefficient": "1", "source": "1", "target": "1", **dict.fromkeys(PAIRS, "1")}

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return those of `SEVERAL`, and each pair (source, target) of forces."""
        pairs = (*((n, n) for n in self.SEVERAL), *self.FORCES)
        return [{"source": float(j), "target": float(i)} for j, i in pairs]

    def _pairs(self, shape: Shape) -> Sequence[tuple[int, int]]:
        several = {-1.0: self.FORCES, -2.0: self.EVERY}
        return several.get(shape["source"], ((int(shape["source"]), int(shape["target"])),))

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """One column per pair: the source's nominal reading on the target."""
        pairs = self._pairs(shape)
        columns = np.zeros((len(view.run.grid), 6, len(pairs)))
        for k, (j, i) in enumerate(pairs):
            columns[:, i, k] = view.path.nominal_wrench[:, j]
        return Signature({Channel("sensing", site): columns})

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the matrix off its diagonal; force from moment and the reverse in proportion to the ranges."""
        sensor, names = robot.force_sensor, ("fx", "fy", "fz", "tx", "ty", "tz")
        ranges = (*sensor.range_force, *sensor.range_torque)
        units = {(False, False): "1", (True, True): "1", (True, False): "1/m", (False, True): "m"}
        limits = {}
        for j, i in self.EVERY:
            limit = robot.tolerances.force_matrix * (1.0 if (i > 2) == (j > 2) else ranges[i] / ranges[j])
            limits[f"force sensor matrix, {names[i]} from {names[j]}"] = (limit, units[j > 2, i > 2])
        return (Tolerated({"source": -2.0, "target": -2.0}, limits),)

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the largest pair of forces of (p,); if all were free, each: the axis that reads, the loaded axis."""
        k = int(np.argmax(np.abs(coefficients[: len(self.FORCES)])))
        j, i = self.FORCES[k] if len(coefficients) > 1 else (shape["source"], shape["target"])
        out = {"coefficient": float(coefficients[k]), "source": float(j), "target": float(i)}
        if len(coefficients) > 1:
            out |= {pair: float(c) for pair, c in zip(self.PAIRS, coefficients, strict=False)}
        return out

    def to_simulator(self, actuator: str, values: Values, robot: Robot) -> list[Part]:
        """Return the pairs of forces by name: every pair where all were free, else the fitted pair."""
        free = {name: value for name, value in values.items() if name in self.PAIRS}
        pair = "xyz"[int(values["target"])] + "xyz"[int(values["source"])]
        return [Part(self.id, actuator, free or {pair: values["coefficient"]})]


class SensorCrosstalk(ForceCrosstalk):
    """Crosstalk of forces in any sensor under one load.

    Its moments are a fixed lever times its forces, so that what moments do to forces cannot be told from the forces.
    """

    kinds = ("sensor",)
    SEVERAL = (-1.0,)


def coupling(pair: str, default: float = 0.0) -> Any:
    """Declare one pair of forces as a parameter: the axis that reads, then the loaded axis."""
    return parameter("1", default, -0.5, 0.5, f"share of the force along {pair[1]} read along {pair[0]}")


@dataclass(frozen=True)
class ForceCrosstalkInPlant(PlantEffect, page=ForceCrosstalk):
    """A force along one axis of the sensor is read along another as well."""

    xy: float = coupling("xy")
    xz: float = coupling("xz", 0.03)
    yx: float = coupling("yx")
    yz: float = coupling("yz")
    zx: float = coupling("zx")
    zy: float = coupling("zy")

    def apply(self, p: PlantParameters) -> None:
        """Add to the sensor's matrix."""
        for name, value in self.parameters.items():
            p.body["wrench_matrix"][0, "xyz".index(name[0]), "xyz".index(name[1])] += value
