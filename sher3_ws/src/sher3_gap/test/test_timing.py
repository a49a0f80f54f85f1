"""Latencies read off an echo that was made with them."""

import numpy as np
import pytest
from recorded import PERIOD, ROBOT, run, stroke
from sher3_gap.stages.exact.law import delayed, shifted
from sher3_gap.stages.exact.timing import constant_latency, demand_in_force, scaled, tick_latency, timing_of

COMMAND = stroke(400, hertz=5.0) + stroke(400, hertz=13.0)


def case(echo):
    return [run(400, command=COMMAND, echo=echo)]


@pytest.mark.parametrize("latency", [0.0, 0.4, 2.65])
def test_a_constant_latency_is_found_and_leaves_nothing(latency):
    found, left = constant_latency([scaled(case(shifted(COMMAND, latency))[0], ROBOT)])
    assert found == pytest.approx(latency, abs=1e-6)
    assert left < 1e-15


def test_commands_in_time_have_no_energy():
    timing = timing_of(case(delayed(COMMAND, 1)), ROBOT)
    assert timing.energy < 1e-20
    assert demand_in_force(case(delayed(COMMAND, 1))[0], ROBOT, timing) is None
    assert timing_of([run(10)], ROBOT) is None


def test_one_late_axis_is_told_alone():
    echo = delayed(COMMAND, 1)
    echo[:, 2] = shifted(COMMAND, 0.5)[:, 2]
    timing = timing_of(case(echo), ROBOT)
    assert timing.alone == 2
    assert timing.latency == pytest.approx([0.0, 0.0, 0.5, 0.0, 0.0], abs=1e-6)
    assert np.median(timing.samples) == pytest.approx(0.5, abs=1e-6)


def test_held_commands_are_counted_as_drops():
    echo = delayed(COMMAND, 1)
    held = np.arange(20, 400, 40)
    echo[held] = delayed(COMMAND, 2)[held]
    timing = timing_of(case(echo), ROBOT)
    assert timing.drops == pytest.approx(len(held) / 398, rel=0.2)
    assert timing.scatter == pytest.approx(0.0, abs=1e-9)


def test_held_commands_leave_the_latency_of_an_axis_as_it_is():
    echo = delayed(COMMAND, 1)
    echo[:, 3] = shifted(COMMAND, 0.4)[:, 3]
    held = np.arange(20, 400, 40)
    echo[held] = delayed(COMMAND, 2)[held]
    timing = timing_of(case(echo), ROBOT)
    assert timing.latency == pytest.approx([0.0, 0.0, 0.0, 0.4, 0.0], abs=1e-5)
    assert timing.apart > 0.5
    assert timing.drops == pytest.approx(len(held) / 398, rel=0.2)
    assert timing.clockwork == 0.0


@pytest.mark.parametrize("ticks", [2, 3, 4])
def test_a_drive_that_looks_at_every_second_to_fourth_tick_is_a_clock(ticks):
    echo = delayed(COMMAND, 1)
    looked = np.arange(400) // ticks * ticks
    timing = timing_of(case(echo[looked]), ROBOT)
    assert timing.clockwork > 0.9


def test_every_tick_tells_its_own_latency_where_the_command_changes():
    command, echo, _ = scaled(case(shifted(COMMAND, 0.3))[0], ROBOT)
    ticks, left = tick_latency(command, echo, np.zeros(5))
    assert np.nanmedian(ticks) == pytest.approx(0.3, abs=1e-6)
    assert np.abs(left).max() < 1e-9


def test_the_demand_in_force_is_what_the_drive_held_and_for_how_long_not():
    signals = case(shifted(COMMAND, 0.25))[0]
    demand = demand_in_force(signals, ROBOT, timing_of([signals], ROBOT))
    assert demand.velocity[10:20] == pytest.approx(delayed(COMMAND, 1)[10:20])
    assert demand.late[10:20] == pytest.approx(0.25, abs=1e-6)
    assert PERIOD > 0.0
