"""The numbers that the law and the modes judge, as diagnostics: ages, wrench and speeds, each with its limit."""

from __future__ import annotations

import math

from sher3_common.reasons import Reason, reading
from sher3_common.stamps import age, nanoseconds, seconds
from sher3_common.vectors import Wrench

from sher3_control.law.admittance import LawInput, LawParameters, LawState
from sher3_control.motion.controller import MotionInput
from sher3_control.settings import MotionSettings

Readings = list[tuple[str, str]]
"""Pairs of key and value of a diagnostic, see `sher3_common.reasons.reading`."""


def law_readings(i: LawInput, state: LawState, p: LawParameters) -> Readings:
    """Return the numbers of one tick of the cooperative law: its input, its memory and its constants."""
    share = max(abs(x) / limit for x, limit in zip(i.wrench, p.range, strict=True))
    return [
        _age(Reason.PEDAL_STALE, "pedal/measured", i.stamp, i.pedal_stamp, p.pedal_age_limit),
        _age(Reason.WRENCH_STALE, "force/measured_cf", i.stamp, i.wrench_stamp, p.wrench_age_limit),
        _age(Reason.JOINTS_STALE, "measured_js", i.stamp, i.joints_stamp, p.joints_age_limit),
        reading(Reason.PEDAL_INVALID, "pedal/measured", i.travel, 1.0, "1"),
        reading(Reason.WRENCH_SATURATED, "force/measured_cf", share, p.saturation, "of the range"),
        reading(Reason.WRENCH_FROZEN, "force/measured_cf", state.repeats + 1, p.frozen_samples, "samples"),
    ]


def felt(wrench: Wrench, bias: Wrench) -> tuple[str, str]:
    """Return the force that the law acts on, without the bias of the tare, as a pair of key and value [N]."""
    return "force [N]", f"{math.dist(wrench[:3], bias[:3]):.6g}"


def motion_readings(i: MotionInput, settings: MotionSettings, speed: float, cap: float) -> Readings:
    """Return the numbers of one tick of the motion modes; `speed` is that of the tip, `cap` its limit [m/s]."""
    limit = nanoseconds(settings.joints_age_limit)
    return [
        _age(Reason.JOINTS_STALE, "measured_js", i.stamp, i.joints_stamp, limit),
        _age(Reason.COMMAND_STALE, "servo_cv", i.stamp, i.twist_stamp, limit),
        reading(Reason.TIP_SPEED, "tip", speed, cap, "m/s"),
    ]


def _age(reason: Reason, source: str, now: int, stamp: int, limit: int) -> tuple[str, str]:
    return reading(reason, source, age(now, stamp), seconds(limit), "s")
