"""Channels and residuals, with numbers worked out by hand."""

import numpy as np
import pytest
from sher3_diagnosis.channel import Channel, Residual

VALUES = np.array([[1.0], [3.0], [100.0]])
OK = np.array([True, True, False])


def test_channels_sort_by_stage_and_read_as_a_path():
    assert sorted([Channel("drive", "b"), Channel("drive", "a")])[0].actuator == "a"
    assert str(Channel("drive", "roll")) == "drive/roll"


def test_rms_counts_only_the_samples_that_count():
    assert Residual(VALUES, OK).rms() == pytest.approx([np.sqrt(5.0)])
    assert Residual(VALUES, np.zeros(3, dtype=bool)).rms() == pytest.approx([0.0])


def test_a_free_mean_is_taken_off_by_its_share():
    values = np.array([[2.0], [4.0]])
    assert Residual(VALUES, OK).relieved(values) == pytest.approx(values)
    assert Residual(VALUES, OK, free_mean=1.0).relieved(values).ravel() == pytest.approx([-1.0, 1.0])
    assert Residual(VALUES, OK, free_mean=0.5).relieved(values).ravel() == pytest.approx([0.5, 2.5])


def test_what_was_taken_off_in_part_can_be_put_back_and_what_was_taken_whole_cannot():
    values = np.array([[2.0], [4.0]])
    partly, wholly = Residual(VALUES, OK, free_mean=0.96), Residual(VALUES, OK, free_mean=1.0)
    assert partly.partly_free and not wholly.partly_free and not Residual(VALUES, OK).partly_free
    assert partly.restored(partly.relieved(values)) == pytest.approx(values)
    assert wholly.restored(wholly.relieved(values)).mean() == pytest.approx(0.0)


def test_a_sample_that_tells_a_part_of_its_components_counts_in_that_part_and_is_left_out_where_all_are_wanted():
    told = np.stack([np.eye(2), np.diag([1.0, 0.0])])
    residual = Residual(np.array([[1.0, 2.0], [3.0, 4.0]]), np.ones(2, dtype=bool), determined=told)
    assert residual.relieved(residual.values).tolist() == [[1.0, 2.0], [3.0, 0.0]]
    assert residual.relieved(residual.values[1:], np.array([False, True])).tolist() == [[3.0, 0.0]]
    assert residual.wholly_determined().ok.tolist() == [True, False] and residual.wholly_determined().determined is None
