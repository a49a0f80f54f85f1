"""Force saturation: the drive cannot give more than a limit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Measured, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter

from sher3_effects.operators import frozen_integral
from sher3_effects.page import Page
from sher3_effects.view import RobotView


class ForceSaturation(Page):
    """F = clamp(PI law, +-limit), integrator frozen while clamped, also between two ticks.

    A drive that runs out of voltage or current bends towards its limit: the force follows the law up to 1 - knee of the
    limit, and reaches the limit where the law asks for 1 + knee of it.
    """

    id, family, stage = "force_saturation", "limit", "drive"
    inputs = ("force", "command")
    gives = ("limit",)
    best = Best("steps", "large and small steps separate limits from lags")
    leaves_out = "that the bend towards the limit is no parabola"
    on_axis = {"limit": "limit"}
    computed = "limit"
    explanation = "The reported force stops rising at a level below the drive's limit; below it the drive behaves."
    siblings = {"drive_lag": "late at every level"}
    finer = {"limit": (0.9, 0.94, 0.97, 0.985, 0.993, 1.007, 1.015, 1.03, 1.06, 1.1), "knee": (0.5, 0.75, 1.3, 1.8)}
    KNEE = 0.25
    """Width of the bend that is tried first, over the limit."""
    LEVELS = 12
    """Limits tried between the largest force that was reported and the largest that was asked for."""
    HELD = 50
    """Ticks at the limit from which their mean tells it."""
    NEAR = 0.93
    """Share of the limit from which three reports in a row are at it."""

    def shapes(self, views: Sequence[RobotView], site: str) -> list[Shape]:
        """Limits from the largest reported force (no limit can be lower) to the largest that the law asked for."""
        axis = views[0].row(site)
        runs = [v.run for v in views if v.run.effort is not None and v.run.echo is not None]
        if not runs:
            return []
        reported = np.quantile(np.concatenate([np.abs(r.effort[:, axis]) for r in runs]), 0.9999)
        asked = max(float(np.max(np.abs(r.effort[:, axis] + self._step(views[0], r, axis)))) for r in runs)
        if reported <= 0.0:
            return []
        return [{"limit": float(x)} for x in np.geomspace(0.98 * reported, max(asked, reported), self.LEVELS)]

    def bends(self, views: Sequence[RobotView], site: str, shape: Shape) -> list[Shape]:
        """Limits near a hard one, with a bend: it begins below."""
        return [{"limit": shape["limit"] * f, "knee": self.KNEE} for f in (0.85, 0.92, 1.0, 1.08)]

    def _step(self, view: RobotView, run: Any, axis: int) -> Array:
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
        knee = shape.get("knee", 0.0)
        constants = (robot.drive.kp, robot.drive.ki, robot.mass, limit, run.period)
        lost = frozen_integral(run.effort[:, axis], law, step, load, ahead, constants, knee)
        clamped = bent(law - robot.drive.ki * lost, limit, knee)
        return Signature({}, {Channel(self.stage, site): run.to_grid(clamped - law)[:, None]})

    def measured(self, views: Sequence[RobotView], site: str, shape: Shape) -> Mapping[str, Measured]:
        """Return the force that is reported while it ends at a hard limit: noise makes no difference to its mean."""
        if shape.get("knee"):
            return {}
        held = [_held(np.abs(v.run.effort[:, v.row(site)]), shape["limit"]) for v in views if v.run.effort is not None]
        force = np.concatenate(held) if held else np.zeros(0)
        if len(force) < self.HELD:
            return {}
        return {"limit": Measured(float(force.mean()), float(force.std() / np.sqrt(len(force))))}


def bent(force: Array, limit: float, knee: float) -> Array:
    """Return forces (n,) held within a limit: straight up to (1 - knee) limit, then a parabola that ends level."""
    size = np.abs(force)
    over = np.clip(size / limit - (1.0 - knee), 0.0, 2.0 * knee)
    soft = np.minimum(size, limit * (1.0 - knee)) + limit * (over - over**2 / (4.0 * knee) if knee > 0.0 else 0.0)
    return np.asarray(np.sign(force) * soft)


def _held(force: Array, limit: float) -> Array:
    """Return the reported force (n,) at the ticks that lie between two others near the limit."""
    near = force > ForceSaturation.NEAR * limit
    near[1:-1] &= near[:-2] & near[2:]
    return force[near]


@dataclass(frozen=True)
class ForceSaturationInPlant(PlantEffect, page=ForceSaturation):
    """The drive's force ends earlier than its data sheet says: current limit, supply, temperature derating."""

    limit: float = parameter("N", 20.0, 0.5, 200.0, "largest force of the drive", on="limit", change=np.minimum)
