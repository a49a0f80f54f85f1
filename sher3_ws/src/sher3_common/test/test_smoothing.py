"""Smoothing by polynomials: exact on polynomials, and what the library's filter gives."""

import numpy as np
import pytest
from scipy.signal import savgol_filter
from sher3_common.numbers.smoothing import savitzky_golay


def test_a_polynomial_and_its_derivatives_are_left_as_they_are():
    t = 0.1 * np.arange(9)
    x = 1.0 - 2.0 * t + 3.0 * t**3
    for deriv, expected in enumerate((x, -2.0 + 9.0 * t**2, 18.0 * t)):
        assert savitzky_golay(x, 5, 3, deriv, 0.1) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(("window", "order", "deriv"), [(5, 2, 0), (21, 3, 1), (31, 3, 2), (1, 0, 0), (7, 0, 1)])
@pytest.mark.parametrize("shape", [(31,), (200, 6)])
def test_it_is_the_filter_of_the_library(window, order, deriv, shape):
    x = np.random.default_rng(1).normal(size=shape)
    expected = savgol_filter(x, window, order, deriv=deriv, delta=0.002, axis=0)
    found = savitzky_golay(x, window, order, deriv, 0.002)
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9 * max(1.0, np.abs(expected).max()))


def test_a_window_is_no_longer_than_the_signal():
    with pytest.raises(ValueError, match="window"):
        savitzky_golay(np.zeros(4), 5, 2)
