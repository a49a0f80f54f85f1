"""Do the two encoders of an axis and its drive agree? Three numbers per axis and tick, each with a limit and a memory.

Motor encoder, load encoder and the integral of the velocity demand say the same thing three times. The slow part of
their differences (lead error, temperature, the elastic deflection under a steady load) is followed with the time
constant `memory` and only the rest is judged, as a distance that must last longer than a latency. Limit and latency
per joint are the two numbers of dVRK's encoder check.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from sher3_description.reasons import Reason, reading

from .feedback import Feedback
from .settings import MotorDriverSettings
from .trips import Trip
from .units import AxisScale

_HOLE = 10


class AxisLimits(NamedTuple):
    """Limits of one axis in its own unit (m or rad), and their times in ticks.

    Attributes:
        apart: motor minus load position, without its slow part.
        apart_total: the same since the drives were enabled; more is a trip at once.
        apart_ticks: how long `apart` may be exceeded.
        astray: integrated demand minus motor motion, without its slow part, at rest.
        lag: what the demanded speed adds to `astray`, s.
        astray_ticks: how long that may be exceeded.
        forget_apart, forget_astray: share of a difference that is taken as its slow part in a tick.
    """

    apart: float
    apart_total: float
    apart_ticks: int
    astray: float
    lag: float
    astray_ticks: int
    forget_apart: float
    forget_astray: float


def axis_limits(scale: AxisScale, settings: MotorDriverSettings) -> AxisLimits:
    """Return the limits of an axis from the settings of its kind."""
    s, period = settings, settings.period
    apart, total, astray = (
        (s.encoder_angle, s.encoder_total_angle, s.following_angle)
        if scale.revolute
        else (s.encoder_distance, s.encoder_total_distance, s.following_distance)
    )
    return AxisLimits(
        apart,
        total,
        max(1, math.ceil(s.encoder_latency / period - 1e-9)),
        astray,
        s.following_lag,
        max(1, math.ceil(s.following_latency / period - 1e-9)),
        min(1.0, period / s.encoder_memory),
        min(1.0, period / s.following_memory),
    )


class AxisCheck:
    """The checks of one axis.

    Attributes:
        gap: newest motor minus load position without its slow part.
        error: newest following error without its slow part.
        error_limit: its limit at the demanded speed.
    """

    __slots__ = (
        "_base", "_follow", "_follow_load", "_gap_ticks", "_l", "_load", "_load_mark", "_motor", "_motor_mark", "_name",
        "_peak", "_stray_ticks", "_total", "_unit", "error", "error_limit", "gap",
    )  # fmt: skip

    def __init__(self, name: str, unit: str, limits: AxisLimits) -> None:
        self._name, self._unit, self._l = name, unit, limits
        self.begin(0.0, 0.0)

    def begin(self, motor: float, load: float) -> None:
        """Take these readings as what belongs together."""
        self._base = self._total = motor - load
        self._motor = self._motor_mark = motor
        self._load = self._load_mark = load
        self._follow = self._follow_load = self._peak = 0.0
        self._gap_ticks = self._stray_ticks = 0
        self.gap = self.error = 0.0
        self.error_limit = self._l.astray

    def check(self, motor: float, load: float, advance: float, speed: float) -> Trip | None:
        """Judge a tick: readings, the demand integrated since the last one, and the demanded speed."""
        limits = self._l
        step_motor, step_load = motor - self._motor, load - self._load
        keep = 1.0 - limits.forget_astray
        self.error = self._follow = keep * self._follow + advance - step_motor
        self._follow_load = keep * self._follow_load + advance - step_load
        peak = self._peak = max(abs(speed), keep * self._peak)
        self.error_limit = limits.astray + limits.lag * peak
        gap = motor - load
        self.gap = fast = gap - self._base
        self._base += limits.forget_apart * fast
        self._motor, self._load = motor, load
        self._gap_ticks = self._gap_ticks + 1 if abs(fast) > limits.apart else 0
        self._stray_ticks = self._stray_ticks + 1 if abs(self.error) > self.error_limit else 0
        if step_motor:
            self._load_mark = load
        if step_load:
            self._motor_mark = motor
        one_moved = (step_motor == 0.0) != (step_load == 0.0)
        far = abs(gap - self._total) > limits.apart_total
        return self._judge(gap) if one_moved or far or self._gap_ticks or self._stray_ticks else None

    def _judge(self, gap: float) -> Trip | None:
        """Return the trip, if there is one; the frozen encoder first, since it also drives the others apart."""
        limits, unit = self._l, self._unit
        for frozen, moved in (("load", self._motor - self._motor_mark), ("motor", self._load - self._load_mark)):
            if abs(moved) > limits.apart:
                text = f"{self._name}: {frozen} encoder stands still while the other one moved {moved:.3g} {unit}"
                return Trip(Reason.ENCODER_FROZEN, text, abs(moved), limits.apart, unit)
        total = gap - self._total
        if self._gap_ticks >= limits.apart_ticks or abs(total) > limits.apart_total:
            suspect = "load side" if abs(self._follow) <= abs(self._follow_load) else "motor encoder"
            value, limit = (self.gap, limits.apart) if self._gap_ticks else (total, limits.apart_total)
            text = f"{self._name}: encoders {value:.3g} {unit} apart (limit {limit:.3g}); the {suspect} left the demand"
            return Trip(Reason.ENCODERS_DISAGREE, text, abs(value), limit, unit)
        if self._stray_ticks >= limits.astray_ticks:
            text = f"{self._name}: {self.error:.3g} {unit} off its demand (limit {self.error_limit:.3g})"
            return Trip(Reason.FOLLOWING_ERROR, text, abs(self.error), self.error_limit, unit)
        return None

    @property
    def limit(self) -> float:
        """Limit of `gap`, m or rad."""
        return self._l.apart

    def readings(self) -> list[tuple[str, str]]:
        """Return what is looked at now, with its limits, for the diagnostics."""
        name, unit = self._name, self._unit
        return [
            reading(Reason.ENCODERS_DISAGREE, name, abs(self.gap), self._l.apart, unit),
            reading(Reason.FOLLOWING_ERROR, name, abs(self.error), self.error_limit, unit),
        ]


class JointWatch:
    """The checks of the five axes.

    Attributes:
        axes: one per actuator, in the order of ACTUATORS.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self._hole = max(_HOLE * settings.period, settings.stall_limit)
        units = ["rad" if scale.revolute else "m" for scale in scales]
        self.axes = [
            AxisCheck(scale.name, unit, axis_limits(scale, settings)) for scale, unit in zip(scales, units, strict=True)
        ]

    def check(self, feedback: Feedback, since: float) -> Trip | None:
        """Judge a feedback `since` s after the one before.

        Over ticks that were lost the newest demand is taken to have held. After more than `_HOLE` of them, or than a
        loop may hang, and where nothing came before (0), the axes start afresh: the robot has stopped on their account.
        """
        found = None
        for axis, motor, load, demand in zip(
            self.axes, feedback.motor_position, feedback.load_position, feedback.velocity_demand, strict=True
        ):
            if 0.0 < since <= self._hole:
                found = axis.check(motor, load, demand * since, demand) or found
            else:
                axis.begin(motor, load)
        return found
