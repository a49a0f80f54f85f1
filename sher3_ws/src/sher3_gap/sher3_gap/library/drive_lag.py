"""Drive lag: the drive answers late, like a first-order filter."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of
from sher3_gap.library.operators import first_order


class DriveLag(LibraryEffect):
    """effort = first-order lag of the PI law."""

    id, family, stage = "drive_lag", "timing", "drive"
    explanation = (
        "The force follows the velocity loop's demand with a lag: too small at the start of each step, too "
        "large at its end."
    )
    siblings = {"command_delay": "the echo itself is late", "torque_constant": "a ratio, no lag"}
    units = {"time_constant": "s"}
    TIMES = (0.0002, 0.0005, 0.001, 0.0015, 0.002, 0.003, 0.004, 0.006, 0.009, 0.013, 0.02)

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Time constant, of the force (0) or of the velocity demand (1)."""
        return [{"time_constant": t, "of_demand": d} for t in self.TIMES for d in (0.0, 1.0)]

    def refine(self, shape: Shape) -> list[Shape]:
        """Between the neighbours."""
        return [{**shape, "time_constant": shape["time_constant"] * f} for f in (0.7, 0.8, 0.9, 1.1, 1.2, 1.35)]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """No coefficient: lagged law minus law."""
        run, axis, time = view.run, axis_of(site), shape["time_constant"]
        assert run.echo is not None
        drive, demand = view.robot.actuators[axis].drive, run.echo[:, axis]
        if shape["of_demand"]:
            change = first_order(demand, demand, time, run.period) - demand
            behind = np.diff(demand, prepend=demand[0]) - np.concatenate([[0.0], change[:-1]])
            missed = np.cumsum(behind) * time * -np.expm1(-run.period / time)
            lagged = drive.kp * change - drive.ki * missed
        else:
            law = view.law[:, axis]
            after_step = law.copy()
            after_step[1:] = law[:-1] + drive.kp * np.diff(demand)
            lagged = first_order(after_step, law, time, run.period) - law
        return Signature({}, {Channel(self.stage, site): run.to_grid(lagged)[:, None]})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Time constant."""
        return {"time_constant": shape["time_constant"]}
