"""Who gives way to whom under SCHED_FIFO, and who keeps to which core."""

from __future__ import annotations

import os

import pytest
from sher3_bringup.errors import NoRealtime
from sher3_bringup.processes import up
from sher3_bringup.processes.up import beside, granted, prepare, priority, shared_core
from sher3_bringup.settings.run_settings import RunSettings


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


@pytest.fixture
def without_rights(monkeypatch):
    monkeypatch.setattr(up, "realtime_permitted", lambda: False)
    monkeypatch.setattr(os, "environ", {**os.environ})


def test_the_robot_needs_real_time_rights_or_a_word_that_it_does_without(without_rights):
    assert (granted(-1), granted(0), granted(7)) == (0, 0, 7)
    robot = RunSettings(mock=False, links=("socketcan:can0",), realtime=-1)
    with pytest.raises(NoRealtime, match=r"limit ulimit -r >= 40; .* or --realtime 0") as caught:
        prepare(robot)
    assert caught.value.exit_code == 3
    assert prepare(robot.model_copy(update={"realtime": 0})) == prepare(RunSettings(realtime=-1)) == 0


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
