"""Do the two encoders of one axis and its drive agree? Two differences per tick, each with a limit and a memory.

Motor encoder, load encoder and the integral of the velocity demand tell the same travel three times. Their differences
have a slow part: lead error, temperature, the elastic deflection under a steady load. It is followed with a time
constant, the memory, and only the rest is judged: a distance that must last longer than a latency. Limit and latency
per joint are the two numbers of dVRK's encoder check.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sher3_common.reasons import Reason, reading

from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.trips import Trip

_ROUNDING = 1e-9
"""Slack of a quotient before it is rounded up to whole ticks: 10 ms over 2 ms must be five of them, not six."""


class AxisLimits(NamedTuple):
    """Limits of one axis in its own unit (m or rad), and their times in ticks.

    Attributes:
        apart: motor minus load position, without its slow part.
        drift: motor minus load position since the drives were enabled, for as long as `apart`.
        drift_share: what the range of the positions since then adds to `drift`.
        apart_total: motor minus load position since the drives were enabled; more is a trip at once.
        apart_ticks: number of ticks for which `apart` may be exceeded.
        astray: integrated demand minus motor motion, without its slow part, at rest.
        lag: what the demanded speed adds to `astray`, s.
        astray_ticks: number of ticks for which `astray` may be exceeded.
        forget_apart, forget_astray: share of either difference that is taken as its slow part in a tick.
    """

    apart: float
    drift: float
    drift_share: float
    apart_total: float
    apart_ticks: int
    astray: float
    lag: float
    astray_ticks: int
    forget_apart: float
    forget_astray: float

    @classmethod
    def of(cls, scale: AxisScale, settings: MotorDriverSettings) -> AxisLimits:
        """Return the limits of an axis from the settings of its kind."""
        s, turns = settings, scale.revolute
        return cls(
            apart=s.encoder_angle if turns else s.encoder_distance,
            drift=s.encoder_drift_angle if turns else s.encoder_drift_distance,
            drift_share=s.encoder_drift_share,
            apart_total=s.encoder_total_angle if turns else s.encoder_total_distance,
            apart_ticks=_ticks(s.encoder_latency, s.period),
            astray=s.following_angle if turns else s.following_distance,
            lag=s.following_lag,
            astray_ticks=_ticks(s.following_latency, s.period),
            forget_apart=min(1.0, s.period / s.encoder_memory),
            forget_astray=min(1.0, s.period / s.following_memory),
        )


def _ticks(latency: float, period: float) -> int:
    """Return a latency [s] in ticks, rounded up, at least one."""
    return max(1, math.ceil(latency / period - _ROUNDING))


class AxisCheck:
    """The check of one axis; positions in m or rad.

    Args:
        name: actuator.
        unit: `m` or `rad`.
        limits: its limits.

    Attributes:
        gap: newest motor minus load position without its slow part.
        drift_limit: limit of motor minus load position since the beginning, over the range of positions so far.
        error: newest following error, demand minus motor motion, without its slow part.
        error_limit: limit of `error` at the demanded speed.
    """

    __slots__ = (
        "_drift_ticks", "_gap_at_start", "_gap_ticks", "_high", "_limits", "_load", "_load_error", "_load_mark", "_low",
        "_motor", "_motor_mark", "_name", "_peak_speed", "_slow_gap", "_stray_ticks", "_unit", "drift_limit", "error",
        "error_limit", "gap",
    )  # fmt: skip

    def __init__(self, name: str, unit: str, limits: AxisLimits) -> None:
        self._name, self._unit, self._limits = name, unit, limits
        self._motor = self._load = 0.0
        self._motor_mark = self._load_mark = 0.0
        self._gap_at_start = self._slow_gap = 0.0
        self._load_error = self._peak_speed = 0.0
        self._gap_ticks = self._drift_ticks = self._stray_ticks = 0
        self._low = self._high = 0.0
        self.gap = self.error = 0.0
        self.drift_limit, self.error_limit = limits.drift, limits.astray

    @property
    def limit(self) -> float:
        """Limit of `gap`, m or rad."""
        return self._limits.apart

    def begin(self, motor: float, load: float) -> None:
        """Start afresh: these readings belong together."""
        self._motor = self._motor_mark = motor
        self._load = self._load_mark = load
        self._gap_at_start = self._slow_gap = motor - load
        self._load_error = self._peak_speed = 0.0
        self._gap_ticks = self._drift_ticks = self._stray_ticks = 0
        self._low = self._high = motor
        self.gap = self.error = 0.0
        self.drift_limit, self.error_limit = self._limits.drift, self._limits.astray

    def check(self, motor: float, load: float, advance: float, speed: float) -> Trip | None:
        """Judge one tick.

        Args:
            motor: reading of the motor encoder.
            load: reading of the load encoder.
            advance: velocity demand integrated since the last readings.
            speed: the demanded velocity, m/s or rad/s.
        """
        motor_step, load_step = motor - self._motor, load - self._load
        self._motor, self._load = motor, load
        if motor_step:
            self._load_mark = load
        if load_step:
            self._motor_mark = motor
        self._follow(motor_step, load_step, advance, speed)
        gap = motor - load
        self._part(gap)
        one_moved = (motor_step == 0.0) != (load_step == 0.0)
        far = abs(gap - self._gap_at_start) > self._limits.apart_total
        return (
            self._judge(gap) if one_moved or far or self._gap_ticks or self._drift_ticks or self._stray_ticks else None
        )

    def _follow(self, motor_step: float, load_step: float, advance: float, speed: float) -> None:
        """Add one tick's demand and the steps of motor and load to what is remembered of their following errors."""
        limits = self._limits
        keep = 1.0 - limits.forget_astray
        self.error = error = keep * self.error + advance - motor_step
        self._load_error = keep * self._load_error + advance - load_step
        self._peak_speed = peak = max(abs(speed), keep * self._peak_speed)
        self.error_limit = limit = limits.astray + limits.lag * peak
        self._stray_ticks = self._stray_ticks + 1 if abs(error) > limit else 0

    def _part(self, gap: float) -> None:
        """Take the newest difference of the encoders apart into its slow part and the rest."""
        limits = self._limits
        self.gap = fast = gap - self._slow_gap
        self._slow_gap += limits.forget_apart * fast
        self._gap_ticks = self._gap_ticks + 1 if abs(fast) > limits.apart else 0
        self._low, self._high = min(self._low, self._motor), max(self._high, self._motor)
        self.drift_limit = limits.drift + limits.drift_share * (self._high - self._low)
        self._drift_ticks = self._drift_ticks + 1 if abs(gap - self._gap_at_start) > self.drift_limit else 0

    def _judge(self, gap: float) -> Trip | None:
        """Return the trip, if there is one.

        A frozen encoder comes first, since it also drives the other differences apart.
        """
        return self._judge_frozen() or self._judge_apart(gap - self._gap_at_start) or self._judge_astray()

    def _judge_frozen(self) -> Trip | None:
        """Object when one encoder has not changed while the other one moved by more than the limit."""
        limit, unit = self._limits.apart, self._unit
        for frozen, moved in (("load", self._motor - self._motor_mark), ("motor", self._load - self._load_mark)):
            if abs(moved) > limit:
                text = f"{self._name}: {frozen} encoder stands still while the other one moved {moved:.3g} {unit}"
                return Trip(Reason.ENCODER_FROZEN, text, abs(moved), limit, unit)
        return None

    def _judge_apart(self, total: float) -> Trip | None:
        """Object when the encoders are apart for too long, or too far since the drives were enabled (`total`)."""
        limits, unit = self._limits, self._unit
        lasting = max(self._gap_ticks, self._drift_ticks)
        if lasting < limits.apart_ticks and abs(total) <= limits.apart_total:
            return None
        suspect = "load side" if abs(self.error) <= abs(self._load_error) else "motor encoder"
        value, limit = (
            (self.gap, limits.apart) if self._gap_ticks else (total, min(self.drift_limit, limits.apart_total))
        )
        text = f"{self._name}: encoders {value:.3g} {unit} apart (limit {limit:.3g}); the {suspect} left the demand"
        return Trip(Reason.ENCODERS_DISAGREE, text, abs(value), limit, unit)

    def _judge_astray(self) -> Trip | None:
        """Object when the motor is off its demand for too long."""
        if self._stray_ticks < self._limits.astray_ticks:
            return None
        text = f"{self._name}: {self.error:.3g} {self._unit} off its demand (limit {self.error_limit:.3g})"
        return Trip(Reason.FOLLOWING_ERROR, text, abs(self.error), self.error_limit, self._unit)

    def readings(self) -> list[tuple[str, str]]:
        """Return the two differences with their limits, for the diagnostics."""
        name, unit = self._name, self._unit
        return [
            reading(Reason.ENCODERS_DISAGREE, name, abs(self.gap), self._limits.apart, unit),
            reading(Reason.FOLLOWING_ERROR, name, abs(self.error), self.error_limit, unit),
        ]
