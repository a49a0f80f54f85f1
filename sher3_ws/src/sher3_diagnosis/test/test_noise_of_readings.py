"""Simulated noise of known size comes back, at every rate, in every unit, with and without counts."""

import numpy as np
import pytest
from sher3_diagnosis.localise.readings import noise_in


def readings(seed, rate, noise, count=0.0, seconds=20.0):
    """A joint that swings, read with noise and rounded to a count; in rad."""
    t = np.arange(int(rate * seconds)) / rate
    x = 0.5 * np.sin(2.5 * t + seed) + 0.2 * np.sin(6.9 * t) + noise * np.random.default_rng(seed).normal(size=len(t))
    return count * np.round(x / count) if count else x


@pytest.mark.parametrize("rate", [250.0, 1000.0])
@pytest.mark.parametrize("counts", [0.0, 0.5, 1.0, 4.0])
def test_noise_of_known_size_comes_back_with_and_without_counts(rate, counts):
    """Rounding to a count c adds c^2 / 12 to the variance; the worst of eight seeds counts."""
    noise = 1e-4
    for seed in range(80, 88):
        found = noise_in("elbow", "position", "rad", [readings(seed, rate, noise, counts * noise)], counts * noise)
        assert found.deviation == pytest.approx(noise * np.hypot(1.0, counts / np.sqrt(12.0)), rel=0.1)
        assert found.resolution == (counts * noise or None)


def test_a_slow_log_of_a_minute_tells_it_too():
    found = [noise_in("elbow", "position", "rad", [readings(s, 50.0, 1e-4, seconds=60.0)]).deviation for s in range(8)]
    assert found == pytest.approx(np.full(8, 1e-4), rel=0.1)


def test_it_scales_with_the_unit_and_is_the_rms_over_records():
    x, y = readings(1, 500.0, 1e-4), readings(2, 500.0, 3e-4)
    each = [noise_in("elbow", "position", "rad", [r]).deviation for r in (x, y)]
    assert noise_in("elbow", "position", "rad", [1e3 * x]).deviation == pytest.approx(1e3 * each[0])
    assert noise_in("elbow", "position", "rad", [x, y]).deviation == pytest.approx(np.hypot(*each) / np.sqrt(2.0))


def test_readings_without_noise_have_none_and_a_count_is_never_less_than_its_rounding():
    assert noise_in("elbow", "position", "rad", [readings(1, 500.0, 0.0)]).deviation == 0.0
    slow = np.round(np.linspace(0.0, 3.0, 5000))
    assert noise_in("elbow", "position", "rad", [slow], 1.0).deviation == pytest.approx(1.0 / np.sqrt(12.0))
