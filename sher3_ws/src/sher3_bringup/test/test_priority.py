"""Who gives way to whom under SCHED_FIFO."""

from __future__ import annotations

import pytest
from sher3_bringup.processes.up import beside, priority


@pytest.mark.parametrize(
    ("process", "expected"),
    [
        (("admittance",), 40),
        (("supervisor",), 30),
        (("pedal",), 30),
        (("pedal", "admittance"), 40),
        (("recorder",), -40),
        (("recorder", "gap_monitor"), -40),
    ],
)
def test_what_runs_beside_the_chain_gives_way(process, expected):
    assert priority(process, 40) == expected


def test_no_real_time_stays_none_and_a_low_one_stays_real_time():
    assert [beside(0), beside(1), beside(5), beside(11)] == [0, 1, 1, 1]
    assert priority(("recorder",), 0) == 0
