"""Force saturation: the drive cannot give more than a limit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.operators import frozen_integral
from sher3_effects.page import Page
from sher3_effects.view import RecordedRun, RobotView


class ForceSaturation(Page):
    """F = clamp(PI law, +-limit), integrator frozen while clamped, also between two ticks."""

    id, family, stage = "force_saturation", "limit", "drive"
    inputs = ("force", "command")
    best = Best("steps", "large and small steps separate limits from lags")
    leaves_out = "how it bends towards the limit"
    on_axis = {"limit": "limit"}
    explanation = "The reported force stops rising at a level below the drive's limit; below it the drive behaves."
    siblings = {"drive_lag": "late at every level"}
    finer = {"limit": (0.9, 0.94, 0.97, 0.985, 0.993, 1.007, 1.015, 1.03, 1.06, 1.1)}
    LEVELS = 12
    """Limits tried between the largest force that was reported and the largest that was asked for."""

    def shapes(self, views: Sequence[RobotView], site: str) -> list[Shape]:
        """Levels from the largest force that was reported, which no limit is below, to the largest asked for."""
        axis = views[0].row(site)
        runs = [v.run for v in views if v.run.effort is not None and v.run.echo is not None]
        if not runs:
            return []
        reported = np.quantile(np.concatenate([np.abs(r.effort[:, axis]) for r in runs]), 0.9999)
        asked = max(float(np.max(np.abs(r.effort[:, axis] + self._step(views[0], r, axis)))) for r in runs)
        if reported <= 0.0:
            return []
        return [{"limit": float(x)} for x in np.geomspace(0.98 * reported, max(asked, reported), self.LEVELS)]

    def _step(self, view: RobotView, run: RecordedRun, axis: int) -> Array:
        """By how much the force steps with the demand at each tick, (n,)."""
        assert run.echo is not None
        return view.robot.actuators[axis].drive.kp * np.diff(run.echo[:, axis], append=run.echo[-1, axis])

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """No coefficient: clamped law minus law."""
        run, axis, limit = view.run, view.row(site), shape["limit"]
        if run.echo is None or run.effort is None:
            return Signature()
        robot, clock = view.robot.actuators[axis], run.stage_clock
        held = np.interp(clock, clock[run.grid], view.path.gravity[:, axis] - view.path.contact_force[:, axis])
        ahead = np.append(run.echo[1:, axis] * run.period - np.diff(run.motor[:, axis]), 0.0)
        load = held + robot.viscous * run.velocity[:, axis]
        law, step = view.law[:, axis] + held[0], self._step(view, run, axis)
        constants = (robot.drive.kp, robot.drive.ki, robot.mass, limit, run.period)
        lost = frozen_integral(run.effort[:, axis], law, step, load, ahead, constants)
        clamped = np.clip(law - robot.drive.ki * lost, -limit, limit)
        return Signature({}, {Channel(self.stage, site): run.to_grid(clamped - law)[:, None]})

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
