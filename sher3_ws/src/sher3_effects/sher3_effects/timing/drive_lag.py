"""Drive lag: the drive answers late, like a first-order filter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import EVERYWHERE, PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.operators import first_order, held_lag
from sher3_effects.page import Page
from sher3_effects.view import AxisView, RobotView


class DriveLag(Page):
    """effort = first-order lag of the PI law."""

    id, family, stage = "drive_lag", "timing", "drive"
    inputs = ("command", "force")
    best = Best("steps", "steps of several amplitudes show a dead time as an onset and a lag as a slope")
    leaves_out = "a second pole"
    explanation = (
        "The force follows the velocity loop's demand with a lag: too small at the start of each step, too "
        "large at its end."
    )
    siblings = {"command_delay": "the echo itself is late", "torque_constant": "a ratio, no lag"}
    TIMES = (0.0002, 0.0005, 0.001, 0.0015, 0.002, 0.003, 0.004, 0.006, 0.009, 0.013, 0.02)
    finer = {"time_constant": (0.7, 0.8, 0.9, 1.1, 1.2, 1.35)}

    def shapes(self, views: Sequence[RobotView], site: str) -> list[Shape]:
        """Time constant, of the force (0) or of the velocity demand (1)."""
        return [{"time_constant": t, "of_demand": d} for t in self.TIMES for d in (0.0, 1.0)]

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """No coefficient: lagged law minus law."""
        run, axis, time = view.run, view.row(site), shape["time_constant"]
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


class ServoLag(DriveLag):
    """A position servo that follows its reference like a first-order filter: error = reference - filtered reference."""

    kinds = ("servo",)
    on_axis = {"time_constant": "lag"}
    explanation = "The axis follows its reference late, like a first-order filter."
    siblings = {"command_delay": "the whole reference comes late, its shape unchanged"}
    PERIODS = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0)
    """Time constants that are tried, in periods of the record."""
    finer = {"time_constant": (0.8, 0.9, 0.95, 1.05, 1.1, 1.25)}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return the tracking error of the servo."""
        return (Channel("motor_mechanics", site),)

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return time constants, s."""
        return [{"time_constant": n * views[0].run.period} for n in self.PERIODS]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return reference minus filtered reference; nothing is left to fit."""
        reference = view.run.reference
        assert reference is not None
        late = held_lag(reference[:, [view.row(site)]], shape["time_constant"], view.run.period)
        return Signature({}, {self.channels(site)[0]: view.run.to_grid(reference[:, [view.row(site)]] - late)})


@dataclass(frozen=True)
class DriveLagInPlant(PlantEffect, page=DriveLag, sites=EVERYWHERE):
    """The drive's force follows its law with a first-order lag: current loop or filter."""

    time_constant: float = parameter("s", 1e-3, 0.0, 0.02, "of the lag")

    def apply(self, p: PlantParameters) -> None:
        """Lag the force."""
        p.axis["lag"][self.rows] += self.time_constant
