"""Stamps, durations and ages: whole nanoseconds inside, seconds in settings, messages and reports.

A stamp is an integer in ns of the system time. A negative stamp means that no sample has arrived yet.
"""

from __future__ import annotations

import math

from sher3_common.reasons import Reason

SECOND = 1_000_000_000
"""One second [ns]."""

NO_STAMP = -1
"""The stamp of a sample that has not arrived yet."""


def nanoseconds(duration: float) -> int:
    """Return a duration [s] in whole ns."""
    return round(duration * 1e9)


def seconds(duration: int) -> float:
    """Return a duration [ns] in s."""
    return duration * 1e-9


def age(now: int, stamp: int) -> float:
    """Return how old a sample with this stamp is at the time `now` [s], both in ns; infinite where there is none."""
    return seconds(now - stamp) if stamp >= 0 else math.inf


def judge_age(now: int, stamp: int, age_limit: int, ahead_limit: int, missing: Reason, stale: Reason) -> Reason:
    """Judge the stamp of a sample at the tick `now`; all times in ns.

    A late tick may find samples of the next tick, so a sample may be ahead of `now` by `ahead_limit`. A sample further
    ahead means that two clocks disagree.

    Returns:
        MOVING when the sample may be used, else CLOCK, `missing` (no sample) or `stale` (older than `age_limit`).
    """
    if stamp < 0:
        return missing
    if stamp - now > ahead_limit:
        return Reason.CLOCK
    if now - stamp > age_limit:
        return stale
    return Reason.MOVING
