"""Do the two encoders of one axis and its drive agree? Two differences per tick, each with a limit and a memory.

Motor encoder, load encoder and the integral of the velocity demand tell the same travel three times. Their differences
have a slow part: lead error, temperature, the elastic deflection under a steady load. It is followed with a time
constant, the memory, and only the rest is judged: a distance that must last longer than a latency. Limit and latency
per joint are the two numbers of dVRK's encoder check.

The axes of a robot are rows of one table (`AXIS`), which compiled code goes through in every tick.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from sher3_common.compiled import compiled
from sher3_common.reasons import Reason, reading
from sher3_common.vectors import Vector

from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.row import Row
from sher3_drivers.watches.trips import Trip

_ROUNDING = 1e-9
"""Slack of a quotient before it is rounded up to whole ticks: 10 ms over 2 ms must be five of them, not six."""
FARTHEST = 2
"""Ticks that one counts for at most in which encoders are apart by as many limits: healthy ones come to 14 % of one."""
AGREES, LOAD_FROZEN, MOTOR_FROZEN, APART, ASTRAY = range(5)
"""What there is to say of an axis in a tick."""


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


_MEMORY = (
    "motor", "load", "motor_mark", "load_mark", "gap_at_start", "slow_gap", "gap", "error", "load_error", "peak_speed",
    "low", "high", "drift_limit", "error_limit",
)  # fmt: skip
_COUNTS = ("apart_ticks", "astray_ticks", "gap_ticks", "drift_ticks", "stray_ticks")
AXIS = np.dtype(
    [(name, np.float64) for name in (*AxisLimits._fields, *_MEMORY) if name not in _COUNTS]
    + [(name, np.int64) for name in _COUNTS]
)
"""A row: the limits of an axis and what is remembered of it. `gap` is the newest motor minus load position without its
slow part, `drift_limit` the limit of that since the beginning, over the range of positions so far; `error` the newest
following error, demand minus motor motion, without its slow part, `error_limit` its limit at the demanded speed."""


def begin_axes(axes: Any, motor: Vector, load: Vector) -> None:
    """Start afresh, in place: these readings (n,) belong together."""
    for name in (*_MEMORY, "gap_ticks", "drift_ticks", "stray_ticks"):
        axes[name] = 0
    for name in ("motor", "motor_mark", "low", "high"):
        axes[name] = motor
    axes["load"] = axes["load_mark"] = load
    axes["gap_at_start"] = axes["slow_gap"] = axes["motor"] - axes["load"]
    axes["drift_limit"], axes["error_limit"] = axes["drift"], axes["astray"]


@compiled(error_model="numpy")
def judge_axes(axes: Any, motor: Vector, load: Vector, demand: Vector, since: float) -> int:
    """Judge one tick of every axis, in place.

    Args:
        axes: (n,) rows.
        motor: readings of the motor encoders (n,).
        load: readings of the load encoders (n,).
        demand: demanded velocities (n,), m/s or rad/s.
        since: time since the last readings, s.

    Returns:
        What every axis says, three bits each, those of the first axis lowest; 0 when none objects.
    """
    said = 0
    for number in range(len(axes)):
        what = _judge_axis(axes[number], motor[number], load[number], demand[number] * since, demand[number])
        said |= what << 3 * number
    return said


@compiled(error_model="numpy")
def _judge_axis(axis: Any, motor: float, load: float, advance: float, speed: float) -> int:
    """Judge one tick of an axis; `advance` is the demanded `speed` integrated since the last readings."""
    motor_step, load_step = motor - axis["motor"], load - axis["load"]
    axis["motor"], axis["load"] = motor, load
    if motor_step != 0.0:
        axis["load_mark"] = load
    if load_step != 0.0:
        axis["motor_mark"] = motor
    _follow(axis, motor_step, load_step, advance, speed)
    gap = motor - load
    _part(axis, gap)
    one_moved = (motor_step == 0.0) != (load_step == 0.0)
    far = abs(gap - axis["gap_at_start"]) > axis["apart_total"]
    if one_moved or far or axis["gap_ticks"] or axis["drift_ticks"] or axis["stray_ticks"]:
        return _say(axis, far)
    return AGREES


@compiled(error_model="numpy")
def _follow(axis: Any, motor_step: float, load_step: float, advance: float, speed: float) -> None:
    """Add one tick's demand and the steps of motor and load to what is remembered of their following errors."""
    keep = 1.0 - axis["forget_astray"]
    axis["error"] = keep * axis["error"] + advance - motor_step
    axis["load_error"] = keep * axis["load_error"] + advance - load_step
    axis["peak_speed"] = max(abs(speed), keep * axis["peak_speed"])
    axis["error_limit"] = axis["astray"] + axis["lag"] * axis["peak_speed"]
    axis["stray_ticks"] = axis["stray_ticks"] + 1 if abs(axis["error"]) > axis["error_limit"] else 0


@compiled(error_model="numpy")
def _part(axis: Any, gap: float) -> None:
    """Take the newest difference of the encoders apart into its slow part and the rest."""
    axis["gap"] = fast = gap - axis["slow_gap"]
    axis["slow_gap"] += axis["forget_apart"] * fast
    far = min(FARTHEST, int(abs(fast) / axis["apart"]))
    axis["gap_ticks"] = axis["gap_ticks"] + far if far else 0
    axis["low"], axis["high"] = min(axis["low"], axis["motor"]), max(axis["high"], axis["motor"])
    axis["drift_limit"] = axis["drift"] + axis["drift_share"] * (axis["high"] - axis["low"])
    axis["drift_ticks"] = axis["drift_ticks"] + 1 if abs(gap - axis["gap_at_start"]) > axis["drift_limit"] else 0


@compiled(error_model="numpy")
def _say(axis: Any, far: bool) -> int:
    """Return what there is to say; `far`: the encoders are too far apart since the drives were enabled.

    One encoder that has not changed while the other one moved by more than the limit comes first, since it also drives
    the other differences apart. Then encoders that are apart for too long or too far, then a motor off its demand.
    """
    if abs(axis["motor"] - axis["motor_mark"]) > axis["apart"]:
        return LOAD_FROZEN
    if abs(axis["load"] - axis["load_mark"]) > axis["apart"]:
        return MOTOR_FROZEN
    if max(axis["gap_ticks"], axis["drift_ticks"]) >= axis["apart_ticks"] or far:
        return APART
    return ASTRAY if axis["stray_ticks"] >= axis["astray_ticks"] else AGREES


class AxisCheck(Row):
    """One axis in words; positions in m or rad.

    Args:
        scale: of the axis.
        settings: its limits.
        axes: rows of all axes.
        number: of its row.
    """

    __slots__ = ()

    def __init__(self, scale: AxisScale, settings: MotorDriverSettings, axes: Any, number: int) -> None:
        super().__init__(scale, axes, number, AxisLimits.of(scale, settings)._asdict())

    @property
    def limit(self) -> float:
        """Limit of `gap`, m or rad."""
        return self["apart"]

    def trip(self, what: int) -> Trip:
        """Return the objection to what there is to say."""
        if what == APART:
            return self._apart()
        if what == ASTRAY:
            error, limit, unit = self["error"], self["error_limit"], self._unit
            text = f"{self._name}: {error:.3g} {unit} off its demand (limit {limit:.3g})"
            return Trip(Reason.FOLLOWING_ERROR, text, abs(error), limit, unit)
        frozen, other = ("load", "motor") if what == LOAD_FROZEN else ("motor", "load")
        moved, limit, unit = self[other] - self[f"{other}_mark"], self["apart"], self._unit
        text = f"{self._name}: {frozen} encoder stands still while the other one moved {moved:.3g} {unit}"
        return Trip(Reason.ENCODER_FROZEN, text, abs(moved), limit, unit)

    def _apart(self) -> Trip:
        """Return the objection to encoders that are apart for too long, or too far since the drives were enabled."""
        suspect = "load side" if abs(self["error"]) <= abs(self["load_error"]) else "motor encoder"
        value, limit = self["gap"], self["apart"]
        if not self["gap_ticks"]:
            value = self["motor"] - self["load"] - self["gap_at_start"]
            limit = min(self["drift_limit"], self["apart_total"])
        text = (
            f"{self._name}: encoders {value:.3g} {self._unit} apart (limit {limit:.3g}); the {suspect} left the demand"
        )
        return Trip(Reason.ENCODERS_DISAGREE, text, abs(value), limit, self._unit)

    def readings(self) -> list[tuple[str, str]]:
        """Return the two differences with their limits, for the diagnostics."""
        name, unit = self._name, self._unit
        return [
            reading(Reason.ENCODERS_DISAGREE, name, abs(self["gap"]), self["apart"], unit),
            reading(Reason.FOLLOWING_ERROR, name, abs(self["error"]), self["error_limit"], unit),
        ]
