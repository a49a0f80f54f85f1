"""Force saturation: the drive cannot give more than a limit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.operators import clamped_law
from sher3_effects.page import Page
from sher3_effects.view import RobotView


class ForceSaturation(Page):
    """F = clamp(PI law, +-limit), integrator frozen while clamped."""

    id, family, stage = "force_saturation", "limit", "drive"
    inputs = ("force", "command")
    best = Best("steps", "large and small steps separate limits from lags")
    on_axis = {"limit": "limit"}
    explanation = "The reported force stops rising at a level below the drive's limit; below it the drive behaves."
    siblings = {"drive_lag": "late at every level"}
    finer = {"limit": (0.9, 0.94, 0.97, 0.985, 1.015, 1.03, 1.06, 1.1)}

    def shapes(self, views: Sequence[RobotView], site: str) -> list[Shape]:
        """Levels among the largest reported forces."""
        axis = views[0].row(site)
        largest = np.concatenate([np.abs(v.run.effort[:, axis]) for v in views if v.run.effort is not None])
        levels = np.quantile(largest, [0.9, 0.95, 0.97, 0.98, 0.99, 0.995, 0.999])
        return [{"limit": float(x)} for x in np.unique(levels) if x > 0.0]

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """No coefficient: clamped law minus law."""
        run, axis = view.run, view.row(site)
        assert run.echo is not None
        drive = view.robot.actuators[axis].drive
        start = float(view.path.gravity[0, axis] - view.path.contact_force[0, axis])
        clamped, free = clamped_law(
            run.echo[:, axis], run.smooth[:, axis], drive.kp, drive.ki, shape["limit"], start, run.period
        )
        return Signature({}, {Channel(self.stage, site): run.to_grid(clamped - free)[:, None]})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Limit."""
        return {"limit": shape["limit"]}


@dataclass(frozen=True)
class ForceSaturationInPlant(PlantEffect, page=ForceSaturation):
    """The drive's force ends earlier than its data sheet says: current limit, supply, temperature derating."""

    limit: float = parameter("N", 20.0, 0.5, 200.0, "largest force of the drive")

    def apply(self, p: PlantParameters) -> None:
        """Lower the force limit."""
        p.axis["limit"][self.rows] = np.minimum(p.axis["limit"][self.rows], self.limit)
