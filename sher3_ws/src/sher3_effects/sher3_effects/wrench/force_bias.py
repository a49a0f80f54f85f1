"""Force bias: the sensor reads a constant at no load."""

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


class ForceBias(Page):
    """reading = wrench + (fx, fy, fz, tx, ty, tz)."""

    id, family, stage = "force_bias", "wrench", "sensing"
    breaks = "force_sensor"
    kinds = ("robot", "sensor")
    seen_at = (("sensing", "force_sensor"),)
    best = Best("loads", "known loads in several orientations separate bias, weight and cross-talk")
    places = ("force_sensor",)
    gives = ("fx", "fy", "fz", "tx", "ty", "tz")
    explanation = "The force sensor is off by a constant in its own frame, in every pose and under every load."
    siblings = {"tool_gravity": "turns with roll and tilt", "force_drift": "grows with temperature"}

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Six columns of ones."""
        return Signature({Channel("sensing", site): np.tile(np.eye(6), (len(view.run.grid), 1, 1))})

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the bias of every component."""
        limits = robot.tolerances
        force = {f"force sensor bias, {n}": (limits.force_bias, "N") for n in ("fx", "fy", "fz")}
        return (
            Tolerated({}, force | {f"force sensor bias, {n}": (limits.torque_bias, "N*m") for n in ("tx", "ty", "tz")}),
        )


class CellBias(Page):
    """The zero of a load cell, which has one component: reading = force + bias."""

    id, family, stage, best = ForceBias.id, ForceBias.family, ForceBias.stage, ForceBias.best
    kinds, places = ("cell",), ("load_cell",)
    gives = ("force",)
    units = {"force": "N"}
    explanation = "The load cell reads a constant at no force."
    siblings = {"force_scale": "grows with the force", "force_drift": "wanders during the test"}

    def signature(self, view: CellView, site: str, shape: Shape) -> Signature:
        """Return one column of ones."""
        return Signature({Channel(self.stage, site): column(np.ones(len(view.applied)))})


@dataclass(frozen=True)
class ForceBiasInPlant(PlantEffect, page=ForceBias):
    """The force sensor's zero is off by a constant in its own frame."""

    fx: float = parameter("N", 0.05, -12.0, 12.0, "along x of {f}")
    fy: float = parameter("N", 0.0, -12.0, 12.0, "along y of {f}")
    fz: float = parameter("N", 0.0, -17.0, 17.0, "along z of {f}")
    tx: float = parameter("N*m", 0.0, -0.12, 0.12, "about x of {f}")
    ty: float = parameter("N*m", 0.0, -0.12, 0.12, "about y of {f}")
    tz: float = parameter("N*m", 0.0, -0.12, 0.12, "about z of {f}")

    def apply(self, p: PlantParameters) -> None:
        """Add the bias."""
        p.body["wrench_bias"][0] += (self.fx, self.fy, self.fz, self.tx, self.ty, self.tz)
