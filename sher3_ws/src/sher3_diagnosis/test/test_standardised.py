"""Standardising: residuals over their floor, flattened in the order samples, then components."""

import numpy as np
import pytest
from sher3_diagnosis.channel import Channel, Residual
from sher3_diagnosis.fit.standardised import Standardised

TIP = Channel("mechanism", "tip")
VALUES = np.array([[2.0, 30.0], [4.0, 60.0], [6.0, 90.0]])


def standardised(ok=(True, False, True), free_mean=0.0):
    residuals = [{TIP: Residual(VALUES, np.array(ok), free_mean)}]
    return Standardised([None], residuals, [{TIP: np.array([2.0, 30.0])}])


def test_samples_that_count_are_divided_by_the_floor_of_their_component():
    assert standardised().target[0][TIP] == pytest.approx([1.0, 1.0, 3.0, 3.0])
    assert standardised().null_loss == {(0, TIP): pytest.approx(20.0)}
    assert standardised().samples == {(0, TIP): 4}


def test_columns_are_standardised_like_the_residual():
    columns = np.stack([VALUES, 2.0 * VALUES], axis=-1)
    flat = standardised().flat(0, TIP, columns)
    assert flat[:, 0] == pytest.approx([1.0, 1.0, 3.0, 3.0])
    assert flat[:, 1] == pytest.approx([2.0, 2.0, 6.0, 6.0])


def test_the_free_mean_goes_before_the_floor():
    assert standardised(free_mean=1.0).target[0][TIP] == pytest.approx([-1.0, -1.0, 1.0, 1.0])


def test_a_channel_without_samples_has_no_target():
    assert standardised(ok=(False, False, False)).target == [{}]
