"""Drive lag: the drive answers late, like a first-order filter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import EVERYWHERE, PlantEffect, parameter

from sher3_effects.delay import tried
from sher3_effects.operators import first_order, held_lag, lagged, oscillator, taken_by_limit
from sher3_effects.page import Page
from sher3_effects.view import AxisView, RobotView


class DriveLag(Page):
    """effort = lag of the PI law, of first order or with a second pole that takes a share of its time.

    A loop that is late enough swings up to its own limit: what the limit takes off is part of the law.
    """

    id, family, stage = "drive_lag", "timing", "drive"
    inputs = ("command", "force")
    gives: ClassVar[tuple[str, ...]] = ("time_constant",)
    best = Best("steps", "steps of several amplitudes show a dead time as an onset and a lag as a slope")
    leaves_out = "how its current loop rings"
    explanation = (
        "The force follows the velocity loop's demand with a lag: too small at the start of each step, too "
        "large at its end."
    )
    siblings = {"command_delay": "the echo itself is late", "torque_constant": "a ratio, no lag"}
    TIMES = (0.0002, 0.0005, 0.001, 0.0015, 0.002, 0.003, 0.004, 0.006, 0.009, 0.013, 0.02)
    bent_from = 0.005
    SECOND = (0.2, 0.5)
    """Share of the time that a second pole takes; half is the most."""
    finer: ClassVar[Mapping[str, tuple[float, ...]]] = {
        "time_constant": (0.7, 0.8, 0.9, 1.1, 1.2, 1.35),
        "second": (0.6, 0.8, 1.25),
    }

    def shapes(self, views: Sequence[RobotView], site: str) -> list[Shape]:
        """Time constant, of the force (0) or of the velocity demand (1)."""
        return [{"time_constant": t, "of_demand": d} for t in self.TIMES for d in (0.0, 1.0)]

    def bends(self, views: Sequence[RobotView], site: str, shape: Shape) -> list[Shape]:
        """Return the shape with a second pole, for each of its shares of the time constant; a demand has none."""
        return [] if shape.get("of_demand") != 0.0 else [{**shape, "second": share} for share in self.SECOND]

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """No coefficient: lagged law minus law."""
        run, axis, time = view.run, view.row(site), shape["time_constant"]
        assert run.echo is not None
        drive, demand = view.robot.actuators[axis].drive, run.echo[:, axis]
        if shape["of_demand"]:
            change = first_order(demand, demand, demand, time, run.period) - demand
            behind = np.diff(demand, prepend=demand[0]) - np.concatenate([[0.0], change[:-1]])
            missed = np.cumsum(behind) * time * -np.expm1(-run.period / time)
            late = drive.kp * change - drive.ki * missed
        else:
            law, (start, middle) = view.law[:, axis], self._between(view, axis, drive.kp)
            second = min(shape.get("second", 0.0), 0.5) * time
            force = first_order(start, middle, law, time - second, run.period)
            if second:
                force = lagged(force, second, run.period)
            late = force - law + self._ended(view, axis, time)
        return Signature({}, {Channel(self.stage, site): run.to_grid(late)[:, None]})

    def _ended(self, view: RobotView, axis: int, time: float) -> Array:
        """Return what the drive's own limit adds to a late force (n,): nothing where it is never reached."""
        run, drive = view.run, view.robot.actuators[axis].drive
        assert run.echo is not None
        error = run.echo[:, axis] - np.diff(run.motor[:, axis], prepend=run.motor[0, axis]) / run.period
        gains = np.array([drive.kp, drive.ki, drive.limit])
        return taken_by_limit(error, float(run.effort[0, axis]), gains, time, run.period)

    def _between(self, view: RobotView, axis: int, kp: float) -> tuple[Array, Array]:
        """Return the law (n,) behind the step of the tick before, and its mean over the interval.

        The travel in the interval says the mean speed in it; a line between the speeds at its ends would not.
        """
        run, law = view.run, view.law[:, axis]
        assert run.echo is not None
        demand, motor = run.echo[:, axis], run.motor[:, axis]
        start, middle = law.copy(), law.copy()
        start[1:] = law[:-1] + kp * np.diff(demand)
        speed = np.gradient(motor, run.period)
        middle[1:] = 0.5 * (start[1:] + law[1:]) + kp * (0.5 * (speed[:-1] + speed[1:]) - np.diff(motor) / run.period)
        return start, middle


class ServoLag(DriveLag):
    """A position servo that follows its reference like a filter: error = reference - filtered reference.

    The filter is of first order, or of second order where mass and stiffness of the servo show. A servo whose law also
    looks at speeds is told by its balance: error = time * velocity + inertia * acceleration - rate * (its own slope).
    """

    kinds = ("servo",)
    seen_at = (("motor_mechanics", ""),)
    plain = True
    on_axis = {"time_constant": "lag"}
    explanation = "The axis follows its reference late, like a filter of first order, or of second with a damping."
    siblings = {"command_delay": "the whole reference comes late, its shape unchanged"}
    PERIODS = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0)
    """Time constants that are tried, in periods of the record."""
    DAMPINGS = (0.4, 0.7, 0.95)
    """Of a filter of second order."""
    LAGS, LATE = (1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0), (1.0, 2.0, 3.0, 4.0, 6.0, 8.0)
    """Time constants and dead times that are tried together, in periods of the record; balances are later, too."""
    LEAST_OF_SECOND = 1.5
    """Periods from which a filter of second order is tried: below it the record does not show the difference."""
    BALANCE = ("time_constant", "inertia", "rate")
    """Numbers of a balance: of the speed, of the acceleration, of the error's slope; as many as told."""
    MOST_DAMPED = 0.99
    """Beyond it a filter of second order is two of the first."""
    units = {"time_constant": "s", "delay": "s", "inertia": "s^2", "rate": "s"}
    bounds = {"rate": (0.0, np.inf)}
    finer = {
        "time_constant": (0.8, 0.9, 0.95, 1.05, 1.1, 1.25),
        "damping": (0.8, 0.9, 1.1),
        "delay": (0.7, 0.85, 1.2, 1.4),
    }

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return time constants, s, and for a filter of second order its damping."""
        period = views[0].run.period
        slow = [n * period for n in self.PERIODS if n >= self.LEAST_OF_SECOND]
        first: list[Shape] = [{"time_constant": n * period} for n in self.PERIODS]
        second = [{"time_constant": t, "damping": z} for t in slow for z in self.DAMPINGS]
        both = [{"time_constant": n * period, "delay": d * period} for n in self.LAGS for d in self.LATE]
        return [*first, *second, *both, *({"balance": n} for n in (1.0, 2.0, 3.0))]

    def plain_shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return balances of one number and of two, at once and a dead time later.

        A balance stands beside other forces, as a filtered reference does not.
        """
        late = [{"delay": t} for t in tried(self.LATE, views[0].run.period)]
        return [{"balance": n, **after} for n in (1.0, 2.0) for after in ({}, *late)]

    def plainer(self, views: Sequence[AxisView], site: str, shape: Shape) -> list[Shape]:
        """Return the balance without its last number; a slope of the error may have stood for a dead time."""
        fewer = shape.get("balance", 1.0) - 1.0
        late = [x for x in self.plain_shapes(views, site) if x["balance"] == fewer]
        return ([{**shape, "balance": fewer}] if fewer == 1.0 else late) if fewer else []

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the time constant, and the damping of a filter of second order or the numbers (p,) of a balance."""
        if "balance" not in shape:
            return dict(shape)
        numbers = dict(zip(self.BALANCE, map(float, coefficients), strict=False))
        return {**numbers, **{name: shape[name] for name in ("delay",) if name in shape}}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether a filter of second order is one, and every number (p,) of a balance is above zero.

        A loop that looks at the error's slope answers earlier for it; one that answered later would have a dead time.
        """
        if "balance" in shape:
            return bool(np.min(coefficients) > 0.0)
        return shape.get("damping", 0.0) < self.MOST_DAMPED

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return reference minus filtered reference; nothing is left to fit."""
        reference = view.run.reference
        assert reference is not None
        asked = reference[:, [view.row(site)]]
        if "balance" in shape:
            return self._balance(view, site, asked, shape)
        time = shape["time_constant"]
        if "delay" in shape:
            before = _ago(view, asked, shape["delay"])
            late = held_lag(before, time, view.run.period) - before[0] + asked[0]
        elif "damping" in shape:
            damping = min(shape["damping"], self.MOST_DAMPED)
            late = oscillator(np.ascontiguousarray(asked), 0.5 / (np.pi * time), damping, view.run.period)
        else:
            late = held_lag(asked, time, view.run.period)
        return Signature({}, {self.channels(site)[0]: view.run.to_grid(asked - late)})

    def _balance(self, view: AxisView, site: str, asked: Array, shape: Shape) -> Signature:
        """Return speed, acceleration and the error's slope, and what a dead time of the reference (n, 1) adds."""
        run, row, channel = view.run, view.row(site), self.channels(site)[0]
        delay = shape.get("delay", 0.0)
        heard = _ago(view, asked, delay) if delay else asked
        slope = np.gradient(heard[:, 0] - run.motor[:, row], run.period)
        parts = (run.velocity[:, row], run.acceleration[:, row], -slope)[: int(shape["balance"])]
        columns = {channel: column(*(run.to_grid(x[:, None])[:, 0] for x in parts))}
        return Signature(columns, {channel: run.to_grid(asked - heard)} if delay else {})


def _ago(view: AxisView, x: Array, delay: float) -> Array:
    """Return a signal (n, 1) of the record as it was `delay` ago, s."""
    clock = view.run.stage_clock
    return np.interp(clock - delay, clock, x[:, 0])[:, None]


@dataclass(frozen=True)
class DriveLagInPlant(PlantEffect, page=DriveLag, sites=EVERYWHERE):
    """The drive's force follows its law with a first-order lag: current loop or filter."""

    time_constant: float = parameter("s", 1e-3, 0.0, 0.02, "of the lag", on="lag")
