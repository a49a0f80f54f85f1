"""The low-pass keeps what is slow, stops what is fast, and shifts nothing."""

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt
from sher3_diagnosis.filter import low_pass, settled

PERIOD = 1e-3
CLOCK = np.arange(2000) * PERIOD


def gain(frequency):
    x = np.sin(2 * np.pi * frequency * CLOCK)
    return np.std(low_pass(x, PERIOD)[500:1500]) / np.std(x[500:1500])


def test_half_the_power_at_the_cut_off_twice_over():
    """Second-order Butterworth, forward and backward: 1/sqrt(2) twice is one half."""
    assert gain(40.0) == pytest.approx(0.5, abs=0.02)
    assert gain(4.0) == pytest.approx(1.0, abs=0.002)
    assert gain(200.0) < 0.01


def test_no_phase_is_added():
    x = np.sin(2 * np.pi * 5.0 * CLOCK)
    y = low_pass(x, PERIOD)
    assert np.argmax(y[200:400]) == np.argmax(x[200:400])


def test_slow_or_short_signals_pass_as_they_are():
    x = np.array([0.0, 1.0, 0.0])
    assert low_pass(x, PERIOD) is x or (low_pass(x, PERIOD) == x).all()
    assert (low_pass(np.sin(CLOCK), 0.01) == np.sin(CLOCK)).all()


def test_a_mask_shrinks_at_its_borders():
    mask = np.array([1, 1, 1, 1, 0, 1, 1, 1], dtype=bool)
    assert settled(mask, 1).tolist() == [True, True, True, False, False, False, True, True]
    assert settled(mask, 2).tolist() == [True, True, False, False, False, False, False, True]


def test_the_compiled_filter_is_that_of_the_library():
    x = np.random.default_rng(0).normal(size=(300, 4)).cumsum(axis=0)
    section = butter(2, 40.0, fs=500.0, output="sos")
    assert low_pass(x, 0.002) == pytest.approx(sosfiltfilt(section, x, axis=0), abs=1e-10)
    assert low_pass(x[:, 0], 0.002) == pytest.approx(low_pass(x, 0.002)[:, 0])
