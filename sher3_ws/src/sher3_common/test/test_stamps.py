"""Stamps in ns, durations in s, and the judgement of a sample's age at its limits."""

from __future__ import annotations

import math

import pytest
from sher3_common.reasons import Reason
from sher3_common.stamps import NO_STAMP, age, judge_age, nanoseconds, seconds

NOW = 1_700_000_000_000_000_000
OLDEST, FARTHEST = 10_000_000, 2_000_000


def test_durations_convert_both_ways():
    assert nanoseconds(0.002) == 2_000_000
    assert nanoseconds(0.0029999999999) == 3_000_000
    assert seconds(1_500_000_000) == 1.5


def test_the_age_of_a_sample_and_of_none():
    assert age(NOW, NOW - 20_000_000) == pytest.approx(0.020)
    assert age(NOW, NOW + 2_000_000) == pytest.approx(-0.002)
    assert age(NOW, NO_STAMP) == math.inf


@pytest.mark.parametrize(
    ("stamp", "expected"),
    [
        (NO_STAMP, Reason.WRENCH_MISSING),
        (0, Reason.WRENCH_STALE),
        (NOW, Reason.MOVING),
        (NOW - OLDEST, Reason.MOVING),
        (NOW - OLDEST - 1, Reason.WRENCH_STALE),
        (NOW + FARTHEST, Reason.MOVING),
        (NOW + FARTHEST + 1, Reason.CLOCK),
    ],
)
def test_a_sample_is_judged_at_its_limits(stamp, expected):
    assert judge_age(NOW, stamp, OLDEST, FARTHEST, Reason.WRENCH_MISSING, Reason.WRENCH_STALE) is expected
