"""Velocity dead-band: the drive ignores small demands."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of


class VelocityDeadband(LibraryEffect):
    """The velocity loop sees 0 while |demand| < width (jump), or the demand less the width (soft)."""

    id, family, stage = "velocity_deadband", "limit", "drive"
    explanation = "Small velocity demands do nothing: the drive echoes them but its force behaves as if they were zero."
    siblings = {"drive_lag": "late at every speed"}
    units = {"width": "m/s"}

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Width, with a jump (0) or soft (1)."""
        top = views[0].robot.actuators[axis_of(site)].limits.velocity
        widths = top * np.geomspace(5e-4, 0.3, 16)
        return [{"width": float(w), "soft": s} for w in widths for s in (0.0, 1.0)]

    def refine(self, shape: Shape) -> list[Shape]:
        """Between the neighbours."""
        return [{**shape, "width": shape["width"] * f} for f in (0.7, 0.8, 0.87, 0.94, 1.07, 1.15, 1.25, 1.4)]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """No coefficient: law of the dead-banded demand minus law."""
        run, axis, width = view.run, axis_of(site), shape["width"]
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

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Width."""
        return {"width": shape["width"]}
