"""Who gives way to whom under SCHED_FIFO, and who keeps to which core."""

from __future__ import annotations

import os

import pytest
from sher3_bringup.processes.up import beside, priority, shared_core


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


LOOP = ("force_sensor", "pedal", "admittance", "kinematics", "motor_driver")


@pytest.mark.parametrize(
    ("processes", "cores", "kept"),
    [
        ([("plant",), LOOP, ("supervisor",)], {0, 1, 3}, [3, 3, None]),
        ([("plant",), LOOP, ("supervisor",)], {2}, [None, None, None]),
        ([LOOP, ("supervisor",)], {0, 1}, [None, None]),
        ([("plant",), *((name,) for name in LOOP)], {0, 1}, [None] * 6),
    ],
)
def test_a_loop_in_one_process_and_its_plant_share_a_core(monkeypatch, processes, cores, kept):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: cores)
    assert [shared_core(process, processes) for process in processes] == kept
