"""Tip errors of a run against its twin, on the ticks that both know."""

from types import SimpleNamespace

import numpy as np
import pytest
from recorded import run
from sher3_gap.simulate.tip import as_built_share, known_at, shared_ticks, tip_error, without_tracker_noise
from sher3_gap.stages.units import TIP
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


def test_what_a_robot_as_built_is_off_by_at_the_tip_is_told_in_floors():
    """Two samples, one deviation of a standard deviation of 3 and 1 floors along x: (9 + 1) / 2 over three floors."""
    column = np.zeros((12, 1))
    column[0], column[6] = 3.0, 1.0
    evidence = SimpleNamespace(floors=[{TIP: np.full(6, 2e-6)}], nuisance=[SimpleNamespace(columns=[{TIP: column}])])
    assert as_built_share(evidence, 0) == pytest.approx(5.0 / 3.0)
