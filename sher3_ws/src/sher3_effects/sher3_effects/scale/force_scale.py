"""Force scale: the sensor reads too much or too little in proportion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import Robot
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.page import Page, Tolerated
from sher3_effects.table_view import CellView
from sher3_effects.view import AxisView

COMPONENTS = ("fx", "fy", "fz", "tx", "ty", "tz")
"""Components of a wrench."""


class ForceScale(Page):
    """reading = (1 + relative) * wrench, of the whole sensor or of one axis."""

    id, family, stage = "force_scale", "scale", "sensing"
    inputs = ("load",)
    breaks = "force_sensor"
    kinds = ("robot", "sensor")
    seen_at = (("sensing", "force_sensor"),)
    gives = ("relative", "axis")
    above = -1.0
    best = Best("sweep", "long constant-speed strokes separate ratios from offsets")
    places = ("force_sensor",)
    discrete = frozenset({"axis"})
    choices = {"axis": {-1.0: "all", -2.0: "forces", **{float(i): name for i, name in enumerate(COMPONENTS)}}}
    tried = tuple({"axis": float(a)} for a in (-1, -2, 0, 1, 2))
    """Forces and moments (-1), forces only (-2), one component of the force."""
    explanation = (
        "The force sensor's reading is off by a constant ratio: nothing without load, more the larger the load."
    )
    siblings = {"force_crosstalk": "a load on one axis shows on another", "force_bias": "does not depend on the load"}

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """One column: the nominal reading of the components concerned."""
        keep = {-1: np.ones(6), -2: np.array([1.0, 1, 1, 0, 0, 0])}.get(int(shape["axis"]))
        if keep is None:
            keep = np.eye(6)[int(shape["axis"])]
        return Signature({Channel("sensing", site): (view.path.nominal_wrench * keep)[:, :, None]})

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the gain of every component: the diagonal of the sensor's matrix."""
        limit = (robot.tolerances.force_matrix, "1")
        return [Tolerated({"axis": float(i)}, {f"force sensor matrix, {n}": limit}) for i, n in enumerate(COMPONENTS)]


class CellScale(Page):
    """The sensitivity of a load cell: reading = (1 + relative) * force."""

    id, family, stage, best = ForceScale.id, ForceScale.family, ForceScale.stage, ForceScale.best
    kinds, places, inputs = ("cell",), ("load_cell",), ForceScale.inputs
    above = -1.0
    gives = ("relative",)
    units = {"relative": "1"}
    explanation = "The load cell reads too much or too little in proportion to the force."
    siblings = {
        "force_bias": "does not depend on the force",
        "force_nonlinearity": "largest in the middle of the range",
    }

    def signature(self, view: CellView, site: str, shape: Shape) -> Signature:
        """Return one column: the known force."""
        return Signature({Channel(self.stage, site): column(view.applied)})


@dataclass(frozen=True)
class ForceScaleInPlant(PlantEffect, page=ForceScale):
    """The force sensor's gain is wrong, in all its channels or in some."""

    relative: float = parameter("1", 0.05, -0.5, 1.0, "reading over wrench, less one")
    axis: float = parameter("1", -1.0, -2.0, 5.0, "component of (force, torque) it is of; -1 all, -2 the forces")

    def apply(self, p: PlantParameters) -> None:
        """Scale the sensor's matrix, or rows of it."""
        chosen = round(self.axis)
        rows = slice(None) if chosen == -1 else slice(0, 3) if chosen == -2 else slice(chosen, chosen + 1)
        p.body["wrench_matrix"][0, rows] *= 1.0 + self.relative
