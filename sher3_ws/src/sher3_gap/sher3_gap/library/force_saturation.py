"""Force saturation: the drive cannot give more than a limit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of
from sher3_gap.library.operators import clamped_law


class ForceSaturation(LibraryEffect):
    """F = clamp(PI law, +-limit), integrator frozen while clamped."""

    id, family, stage = "force_saturation", "limit", "drive"
    explanation = "The reported force stops rising at a level below the drive's limit; below it the drive behaves."
    siblings = {"drive_lag": "late at every level"}
    units = {"limit": "N"}

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Levels among the largest reported forces."""
        axis = axis_of(site)
        largest = np.concatenate([np.abs(v.run.effort[:, axis]) for v in views if v.run.effort is not None])
        levels = np.quantile(largest, [0.9, 0.95, 0.97, 0.98, 0.99, 0.995, 0.999])
        return [{"limit": float(x)} for x in np.unique(levels) if x > 0.0]

    def refine(self, shape: Shape) -> list[Shape]:
        """Between the neighbours."""
        return [{"limit": shape["limit"] * f} for f in (0.9, 0.94, 0.97, 0.985, 1.015, 1.03, 1.06, 1.1)]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """No coefficient: clamped law minus law."""
        run, axis = view.run, axis_of(site)
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
