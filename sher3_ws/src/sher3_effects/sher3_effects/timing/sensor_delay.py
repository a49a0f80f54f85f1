"""Sensor delay: a reading that comes late."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Measured, Shape, Signature, column

from sher3_effects.delay import LONGEST_DELAY, earliest, shifted
from sher3_effects.page import Page
from sher3_effects.view import AxisView


class SensorDelay(Page):
    """reading(t) = truth(t - delay), of the second encoder or of the effort; below zero the position is late.

    By how much a filter may delay a position is bounded: what a drive was told earlier acts late, see `EffortLag`.

    To first order a late encoder is off by delay times velocity and a late effort by delay times its slope. The delay
    that is searched is exact, and one coefficient takes up what is left of it.
    """

    id, family, stage = "sensor_delay", "timing", "sensing"
    inputs = ("velocity", "force")
    kinds: ClassVar[tuple[str, ...]] = ("axis", "servo")
    seen_at = (("transmission", ""), ("motor_mechanics", ""))
    of_recorder = True
    computed = "effort_delay"
    best = Best("sweep", "several speeds tell a lag in time from one in travel")
    explanation = (
        "One reading comes a fixed time after the others: two encoders differ in proportion to the speed, whatever the "
        "direction, and agree at rest."
    )
    siblings = {
        "backlash": "a fixed width at any speed, also just after a reversal at a creep",
        "transmission_hysteresis": "a fixed width at any speed, which builds up over a stroke",
        "viscous_friction": "needs force; both encoders agree",
        "command_delay": "the command is late, all readings agree",
    }
    units = {"load_delay": "s", "effort_delay": "s"}
    PERIODS = (0.1, 0.25, 0.5, 1.0, 2.0, 3.0, 5.0, 8.0, 13.0, 21.0)
    """Delays that are tried, in periods of the record, either way."""
    finer = {"delay": (0.85, 0.95, 1.05, 1.2)}
    REST = (-0.5, 1.0)
    """Share of a searched delay that its coefficient may add; a finer delay is searched for what lies beyond."""
    LEAST = 1.0
    """Smallest delay of such an effort, in periods: less is the shape of a friction at a reversal."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return delays of the load encoder (0) and of the effort (1), s, and the smallest that counts as a delay."""
        row, run = views[0].row(site), views[0].run
        late = [s * n * run.period for n in self.PERIODS for s in (1.0, -1.0) if n * run.period <= LONGEST_DELAY]
        which = [float(k) for k, x in enumerate((run.load, run.effort)) if x is not None and np.any(x[:, row])]
        least = run.UNSTATED * self.LEAST * run.period
        early = earliest(run.period)
        return [
            {"delay": t, "of_effort": k, "least": k * least}
            for k in which
            for t in late
            if not k or (abs(t) >= least and t >= -early)
        ]

    def plain_shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return delays of the effort: between two encoders a gap, a spring and a tendon are late as well."""
        return [shape for shape in self.shapes(views, site) if shape["of_effort"]]

    def refine(self, shape: Shape) -> list[Shape]:
        """Return neighbours of a delay; which reading is late has none."""
        return [{**shape, "delay": shape["delay"] * factor} for factor in self.finer["delay"]]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return what a late reading leaves, and one column for the rest of the delay: its slope."""
        row, run = view.row(site), view.run
        if shape["of_effort"]:
            assert run.effort is not None
            channel, truth = Channel("motor_mechanics", site), run.effort[:, row]
            moved = truth - shifted(truth, run.stage_clock, -shape["delay"])
            slope = -np.gradient(shifted(truth, run.stage_clock, -shape["delay"]), run.period)
        else:
            channel, truth = Channel("transmission", site), run.motor[:, row]
            moved = shifted(truth, run.stage_clock, shape["delay"]) - truth
            slope = -np.gradient(shifted(run.smooth[:, row], run.stage_clock, shape["delay"]), run.period)
        fixed = run.to_grid(moved[:, None])
        return Signature({channel: column(run.to_grid(slope[:, None])[:, 0])}, {channel: fixed})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the delay [s], the shape's and the rest (1,) [s], named after the reading that is late."""
        name = "effort_delay" if shape["of_effort"] else "load_delay"
        return {name: shape["delay"] + float(coefficients[0])}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the fitted rest (1,) [s] is between `REST` times the searched delay.

        Their sum must not be shorter than the least delay.
        """
        whole = abs(shape["delay"] + float(coefficients[0]))
        return bool(self.REST[0] < coefficients[0] / shape["delay"] < self.REST[1] and whole >= shape["least"])

    def at_estimate(self) -> Page:
        """Return the form for an effort whose delay was estimated before: nothing of it is fitted."""
        return TimedEffort()


class TimedEffort(SensorDelay):
    """A late effort whose delay was estimated before and is held: nothing is fitted."""

    kinds = ()
    finer = {}

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return none: the delay is not searched."""
        return []

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return the residual of a late effort; nothing is fitted."""
        found = super().signature(view, site, {**shape, "of_effort": 1.0})
        return Signature({}, found.fixed)

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the delay [s] of the shape; there are no coefficients, (0,)."""
        return {"effort_delay": shape["delay"]}

    def measured(self, views: Sequence[AxisView], site: str, shape: Shape) -> dict[str, Measured]:
        """Return the estimated delay, s, with its standard error."""
        return {"effort_delay": Measured(shape["estimate"], shape["error"])}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return True: what the delay is was settled before; there are no coefficients, (0,)."""
        return True
