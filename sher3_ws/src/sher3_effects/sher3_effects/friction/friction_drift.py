"""Friction that changes with temperature or as the run goes on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import Robot
from sher3_description.contract import REFERENCE_TEMPERATURE
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.friction.bristle import deflection, soften
from sher3_effects.friction.coulomb_friction import CoulombFriction
from sher3_effects.friction.dry import DryFriction
from sher3_effects.page import Part, Values
from sher3_effects.view import AxisView


class FrictionDrift(DryFriction):
    """F = z (force + drift * s), s the warmth or the run-in 1 - exp(-t / tau); it never pushes, cold or warm."""

    id, family, stage = "friction_drift", "friction", "motor_mechanics"
    inputs = ("direction", "time", "temperature")
    best = Best("reversals", "reversals of several amplitudes and speeds separate friction laws")
    leaves_out = "how its level varies over the stroke"
    extends = ("coulomb_friction", "presliding_friction")
    explanation = (
        "Friction is not the same early and late, cold and warm: the step at a reversal changes with time or "
        "temperature."
    )
    siblings = {"coulomb_friction": "the same step in every run"}
    gives = ("force", "drift", "time_constant")
    units = {"drift": "N"}
    TIMES = (0.5, 1.0, 2.0, 4.0, 10.0, 60.0, 300.0)
    finer = {"time_constant": (0.7, 0.85, 1.2, 1.4), "displacement": (0.4,)}
    SLACK = 0.1
    """Share of the larger level by which the smaller may come out below zero: one that runs in to nothing scatters."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Run-in within a run, over the session, or warmth (time constant 0)."""
        fine = 2.5e-3 * views[0].lead(site)
        running_in: list[Shape] = [{"time_constant": t, "displacement": fine} for t in self.TIMES]
        warm = [v.run.temperature - REFERENCE_TEMPERATURE for v in views if v.run.temperature is not None]
        cold, hot = min((float(x.min()) for x in warm), default=0.0), max((float(x.max()) for x in warm), default=0.0)
        if cold == hot:
            return running_in
        return [{"time_constant": 0.0, "displacement": fine, "coldest": cold, "warmest": hot}, *running_in]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Two columns: the constant part and the changing part."""
        z = view.sliding(view.row(site), shape["displacement"])
        run = view.run
        if shape["time_constant"] == 0.0:
            change = np.zeros(run.ticks) if run.temperature is None else run.temperature - REFERENCE_TEMPERATURE
        else:
            change = 1.0 - np.exp(
                -(run.stage_clock + run.session_time * (shape["time_constant"] > 20.0)) / shape["time_constant"]
            )
        return Signature({Channel(self.stage, site): column(run.to_grid(z), run.to_grid(z * change))})

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the change (2,) exceeds a fifth of the level, and friction opposes the motion throughout."""
        marked = abs(coefficients[1]) > 0.2 * abs(coefficients[0])
        ends = [shape.get("coldest", 0.0), shape.get("warmest", 1.0)]
        levels = sorted(float(coefficients[0] + coefficients[1] * s) for s in ends)
        return bool(marked and levels[1] > 0.0 and levels[0] >= -self.SLACK * levels[1])

    def to_simulator(self, actuator: str, values: Values, robot: Robot) -> list[Part]:
        """Return f + d (1 - exp(-t / T)) as a constant level f + d and one of -d that decays."""
        constant, change = values["force"], values["drift"]
        if values["time_constant"] <= 0.0:
            return [Part(CoulombFriction.id, actuator, {"force": constant})]
        decaying = {"force": max(-change, 0.0), "time_constant": values["time_constant"]}
        parts, level = [Part(self.id, actuator, decaying)], constant + change
        return parts if level <= 0.0 else [*parts, Part(CoulombFriction.id, actuator, {"force": level})]


@dataclass(frozen=True)
class FrictionDriftInPlant(PlantEffect, page=FrictionDrift):
    """Extra friction at the start of a run that runs in: force exp(-t / time_constant)."""

    force: float = parameter("N", 1.0, 0.0, 50.0, "extra friction at the start of the run")
    time_constant: float = parameter("s", 2.0, 0.05, 3600.0, "of its decay")
    displacement: float = deflection()

    def apply(self, p: PlantParameters) -> None:
        """Add the decaying level."""
        p.axis["friction_decaying"][self.rows] += self.force
        p.axis["friction_decay_time"][self.rows] = self.time_constant
        soften(p, self.rows, self.displacement)
