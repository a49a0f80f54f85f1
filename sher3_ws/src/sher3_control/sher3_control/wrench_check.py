"""Is a wrench sample believable? Finite, within the rated range, not saturated, not old, not frozen."""

import math
from typing import TypeAlias

from .compiled import compiled
from .reasons import Reason

Wrench: TypeAlias = tuple[float, float, float, float, float, float]
"""Force [N] and torque [N m] of one frame."""


@compiled
def same_wrench(a: Wrench, b: Wrench) -> bool:
    """Return whether two finite wrenches agree in all six axes."""
    return a[0] == b[0] and a[1] == b[1] and a[2] == b[2] and a[3] == b[3] and a[4] == b[4] and a[5] == b[5]


@compiled
def check_wrench(wrench: Wrench, limit: Wrench, saturation: float) -> Reason:
    """Judge the numbers of one sample against the sensor's range `limit` (N, N m); MOVING means no objection."""
    saturated = False
    for i in range(6):
        x = abs(wrench[i])
        if not math.isfinite(x):
            return Reason.WRENCH_NOT_FINITE
    for i in range(6):
        x = abs(wrench[i])
        if x > limit[i]:
            return Reason.WRENCH_OUT_OF_RANGE
        if x >= saturation * limit[i]:
            saturated = True
    return Reason.WRENCH_SATURATED if saturated else Reason.MOVING


def judge_age(now: int, stamp: int, age_limit: int, ahead_limit: int, missing: Reason, stale: Reason) -> Reason:
    """Judge the stamp of a sample against the tick `now` [ns].

    A negative stamp is no sample at all. A late tick may find samples of the next one, up to `ahead_limit`; more is a
    clock fault.
    """
    if stamp < 0:
        return missing
    if stamp - now > ahead_limit:
        return Reason.CLOCK
    if now - stamp > age_limit:
        return stale
    return Reason.MOVING


check_age = compiled(judge_age)
"""`judge_age` for compiled code; from Python an enumeration is a slow argument, so call `judge_age` itself there."""
