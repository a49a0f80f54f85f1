"""Friction that changes with temperature or as the run goes on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column, lead


class FrictionDrift(LibraryEffect):
    """F = z (force + drift * s), s the warmth or the run-in 1 - exp(-t / tau)."""

    id, family, stage = "friction_drift", "friction", "motor_mechanics"
    extends = ("coulomb_friction", "presliding_friction")
    explanation = (
        "Friction is not the same early and late, cold and warm: the step at a reversal changes with time or "
        "temperature."
    )
    siblings = {"coulomb_friction": "the same step in every run"}
    units = {"force": "N", "drift": "N", "time_constant": "s"}
    TIMES = (0.5, 1.0, 2.0, 4.0, 10.0, 60.0, 300.0)

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Run-in within a run, over the session, or warmth (time constant 0)."""
        fine = 2.5e-3 * lead(views[0], site)
        return [{"time_constant": t, "displacement": fine} for t in (0.0, *self.TIMES)]

    def refine(self, shape: Shape) -> list[Shape]:
        """Time constants between the neighbours."""
        time = shape["time_constant"]
        return [{**shape, "time_constant": time * f} for f in (0.7, 0.85, 1.2, 1.4)] if time else []

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Two columns: the constant part and the changing one."""
        z = view.sliding(axis_of(site), shape["displacement"])
        run = view.run
        if shape["time_constant"] == 0.0:
            change = np.zeros(run.ticks) if run.temperature is None else run.temperature - 22.0
        else:
            change = 1.0 - np.exp(
                -(run.stage_clock + run.session_time * (shape["time_constant"] > 20.0)) / shape["time_constant"]
            )
        return Signature({Channel(self.stage, site): column(run.to_grid(z), run.to_grid(z * change))})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Constant part, drift (per kelvin where the time constant is 0) and time constant."""
        return {
            "force": float(coefficients[0]),
            "drift": float(coefficients[1]),
            "time_constant": shape["time_constant"],
        }

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """The change is a marked one."""
        return bool(abs(coefficients[1]) > 0.2 * abs(coefficients[0]))
