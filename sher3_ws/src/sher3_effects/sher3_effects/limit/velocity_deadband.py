"""Velocity dead-band: the drive ignores small demands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import EVERYWHERE, PlantEffect, parameter

from sher3_effects.page import Page
from sher3_effects.view import RobotView


class VelocityDeadband(Page):
    """The velocity loop sees 0 while |demand| < width (jump), or the demand less the width (soft)."""

    id, family, stage = "velocity_deadband", "limit", "drive"
    inputs = ("command",)
    gives = ("width",)
    best = Best("steps", "large and small steps separate limits from lags")
    leaves_out = "its rounded edge"
    explanation = "Small velocity demands do nothing: the drive echoes them but its force behaves as if they were zero."
    siblings = {"drive_lag": "late at every speed"}
    finer = {"width": (0.7, 0.8, 0.87, 0.94, 1.07, 1.15, 1.25, 1.4)}

    def shapes(self, views: Sequence[RobotView], site: str) -> list[Shape]:
        """Width, with a jump (0) or soft (1)."""
        top = views[0].axis(site).top
        widths = top * np.geomspace(5e-4, 0.3, 16)
        return [{"width": float(w), "soft": s} for w in widths for s in (0.0, 1.0)]

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """No coefficient: law of the dead-banded demand minus law."""
        run, axis, width = view.run, view.row(site), shape["width"]
        assert run.echo is not None
        drive = view.robot.actuators[axis].drive
        demand = run.echo[:, axis]
        if shape["soft"]:
            seen = demand - np.clip(demand, -width, width)
        else:
            seen = np.where(np.abs(demand) < width, 0.0, demand)
        change = seen - demand
        force = drive.kp * change + drive.ki * np.cumsum(change) * run.period
        return Signature({}, {Channel(self.stage, site): run.to_grid(force)[:, None]})


@dataclass(frozen=True)
class VelocityDeadbandInPlant(PlantEffect, page=VelocityDeadband, sites=EVERYWHERE):
    """The drive takes a demand within +-width for zero, behind the echo: resolution or a standstill window."""

    width: float = parameter("m/s", 1e-4, 0.0, 5e-3, "half width of the dead zone", on="deadband", change=np.maximum)
