"""The least delay of an effort that is one."""

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
