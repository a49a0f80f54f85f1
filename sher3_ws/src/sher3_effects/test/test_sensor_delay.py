"""The least delay of an effort that is one, and the longest lead."""

from types import SimpleNamespace

import numpy as np
import pytest
from sher3_effects.timing.sensor_delay import SensorDelay


@pytest.mark.parametrize(("rest", "possible"), [(0.0, True), (-0.9e-3, True), (-1.1e-3, False)])
def test_less_than_a_period_of_an_effort_is_no_delay(rest, possible):
    """Two periods of 2 ms are tried, and the coefficient takes some of them away; below 2 ms nothing is named."""
    shape = {"delay": 3e-3, "of_effort": 1.0, "least": 2e-3}
    assert SensorDelay().admissible(shape, np.array([rest])) == possible


def test_a_second_encoder_may_be_late_by_less():
    shape = {"delay": 1e-3, "of_effort": 0.0, "least": 0.0}
    assert SensorDelay().admissible(shape, np.array([-0.4e-3]))


@pytest.mark.parametrize("share", [0.06, 0.15, 0.3, 0.7, 1.6, 4.0])
def test_a_delay_of_any_part_of_a_period_is_within_reach_of_one_that_is_tried(share):
    tried = SensorDelay().PERIODS
    low, high = SensorDelay().REST
    assert any(low < (share - n) / n < high for n in tried)


@pytest.mark.parametrize(("period", "lead"), [(0.001, 0.02), (0.02, 0.06), (0.05, 0.15)])
def test_an_effort_comes_no_earlier_than_a_filter_delays_the_position(period, lead):
    """221 ms at 50 Hz, of a servo beside others, was their weight; a late effort is another matter."""
    run = SimpleNamespace(load=None, effort=np.ones((9, 1)), period=period, UNSTATED=1.0)
    tried = [shape["delay"] for shape in SensorDelay().shapes([SimpleNamespace(row=lambda _: 0, run=run)], "elbow")]
    assert -1.001 * lead <= min(tried) < 0.0 and max(tried) >= -min(tried)
