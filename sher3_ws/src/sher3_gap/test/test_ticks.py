"""Live recordings: holes are bridged and marked, late samples sorted in, a late computer told from a late robot."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_effects import plants
from sher3_gap.case.loading import signals_of
from sher3_gap.case.ticks import in_order, on_grid, tick_grid
from sher3_gap.errors import CaseError
from sher3_gap.stages.exact.law import controller_error, transport_error, with_lateness
from simulated import ROBOT, runs_of

T = 2_000_000
FULL = 10**18 + T * np.arange(400, dtype=np.int64)
(RUN,) = runs_of(("steps",), repeats=1, duration=2.5)
LIVE = replace(RUN, metadata=replace(RUN.metadata, origin="robot"))


def without(stamps, *ticks):
    return np.delete(stamps, ticks)


def test_a_grid_without_holes_is_itself():
    ticks, lost = tick_grid(FULL, 0.002, "run")
    assert (ticks == FULL).all() and not lost.any()


def test_holes_are_filled_and_marked():
    ticks, lost = tick_grid(without(FULL, 5, 100, 101), 0.002, "run")
    assert (ticks == FULL).all()
    assert np.flatnonzero(lost).tolist() == [5, 100, 101]


@pytest.mark.parametrize("gone", [range(100, 145), range(10, 390, 12)])
def test_long_and_many_holes_are_refused(gone):
    with pytest.raises(CaseError, match="ticks are missing"):
        tick_grid(without(FULL, *gone), 0.002, "run")


@pytest.mark.parametrize(("gap", "value"), [("line", 5.0), ("hold", 4.0), ("next", 6.0)])
def test_what_stands_in_a_hole(gap, value):
    values = np.arange(400.0)[:, None]
    filled, missing = on_grid(without(FULL, 5), np.delete(values, 5, axis=0), FULL, "topic", gap)
    assert filled[5, 0] == value and np.flatnonzero(missing).tolist() == [5]


def test_samples_that_came_late_are_put_in_place():
    s = RUN.streams["servo_jv"]
    order = np.arange(len(s.stamp))
    order[[50, 51]] = order[[51, 50]]
    order = np.insert(order, 80, 79)
    mixed = replace(s, stamp=s.stamp[order], columns={n: np.asarray(x)[order] for n, x in s.columns.items()})
    again = in_order(replace(RUN, streams={**RUN.streams, "servo_jv": mixed})).streams["servo_jv"]
    assert (again.stamp == s.stamp).all() and (again.velocity == s.velocity).all()


def live(change):
    signals = signals_of(LIVE, ROBOT)
    return with_lateness(replace(signals, **change(signals), stale=None, held=None), ROBOT)


def test_a_demand_held_once_is_the_computers():
    def late(run):
        echo = run.echo.copy()
        steep = np.argsort(np.abs(np.diff(run.command, axis=0)).max(axis=1))[-2:] + 2
        echo[steep] = run.command[steep - 2]
        return {"echo": echo}

    run = live(late)
    assert run.held is not None and run.held.sum() == 2
    assert np.abs(transport_error(run)).max() < 1e-12


def test_an_old_reading_is_the_computers():
    def stale(run):
        command = run.command.copy()
        moving = int(np.argmax(np.abs(run.echo[:, 0])))
        error = ROBOT.position_gain * (run.reference[moving] - run.load[moving - 1])
        command[moving] = run.reference_velocity[moving] + error
        return {"command": command}

    run = live(stale)
    assert run.stale is not None and run.stale.sum() == 1
    assert np.abs(controller_error(run, ROBOT)).max() < 1e-12


def test_what_happens_all_the_time_is_the_robots():
    run = live(lambda r: {"echo": np.vstack([np.zeros((2, 5)), r.command[:-2]])})
    assert run.held is None
    assert np.abs(transport_error(run)).max() > 0.0


def test_commands_that_are_dropped_often_are_the_robots():
    effects = [plants()["dropped_commands"]("all", probability=0.05)]
    (run,) = runs_of(("sweep",), effects, repeats=1, duration=2.5)
    signals = signals_of(replace(run, metadata=replace(run.metadata, origin="robot")), ROBOT)
    assert signals.held is None
    assert np.abs(transport_error(signals)).max() > 0.0


def test_a_recording_that_is_not_live_is_taken_as_it_is():
    assert signals_of(RUN, ROBOT).held is None and signals_of(RUN, ROBOT).stale is None


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(("late", "gap"), [(60, False), (0, True)])
def test_demands_are_held_no_more_often_than_the_computer_is_late_elsewhere(seed, late, gap):
    """At one tick in sixty of a computer that was late at one in twenty: not the robot's; of one in time they are."""
    draw = np.random.default_rng(seed)

    def held_up(run):
        moves = np.abs(np.diff(run.command, axis=0)).max(axis=1)
        begin = int(draw.integers(30, 200))
        lost = np.zeros(run.ticks, dtype=bool)
        lost[begin : begin + late] = True
        away = np.flatnonzero(moves[1:-2] > np.quantile(moves, 0.3)) + 3
        away = away[(away < begin - 20) | (away > begin + late + 20)]
        echo, steep = run.echo.copy(), draw.choice(away, 20, replace=False)
        echo[steep] = run.command[steep - 2]
        return {"echo": echo, "lost": lost}

    run = live(held_up)
    error = np.abs(transport_error(run)).max(axis=1)
    assert (np.count_nonzero(error > 1e-12) > 10) == gap
