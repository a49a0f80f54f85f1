"""Tip errors of a run against its twin, on the ticks that both know."""

import numpy as np
import pytest
from recorded import run
from sher3_gap.simulate.tip import known_at, shared_ticks, tip_error, without_tracker_noise
from simulated import ROBOT


def tracked(index, position):
    return run(100, tracker_index=np.array(index), tracker_position=np.asarray(position, dtype=float))


def line(ticks):
    return np.stack([np.asarray(ticks, dtype=float)] * 3, axis=1)


def test_only_ticks_within_the_twins_path_are_shared():
    own, twin = tracked([0, 10, 20, 95], line([0, 10, 20, 95])), tracked([5, 15, 90], line([5, 15, 90]))
    assert shared_ticks(own, twin).tolist() == [10, 20]


def test_the_error_is_the_runs_tip_less_the_twins_path():
    """The twin moves one metre a tick; the run is half a metre ahead."""
    ticks = [0, 10, 20, 30, 40]
    own, twin = tracked(ticks, line(ticks) + 0.5), tracked([0, 7, 14, 21, 28, 40], line([0, 7, 14, 21, 28, 40]))
    assert tip_error(own, twin) == pytest.approx(np.full((5, 3), 0.5))


def test_ticks_with_an_unknown_load_do_not_count_unless_it_is_never_known():
    known = np.zeros(100, dtype=bool)
    assert known_at(run(100, contact_known=known), np.array([1, 2])).all()
    known[1] = True
    assert known_at(run(100, contact_known=known), np.array([1, 2])).tolist() == [True, False]
    assert known_at(run(100), np.array([1, 2])).all()


def test_a_silent_tracker_changes_nothing_else():
    quiet = without_tracker_noise(ROBOT)
    assert quiet.tracker.noise_position == quiet.tracker.noise_rotation == 0.0
    assert quiet.tracker.rate == ROBOT.tracker.rate
