"""Whether samples were taken at their stamps or evenly is told by the motion."""

import numpy as np
import pytest
from sher3_chain.joint.moments import timed

PERIOD, N = 0.002, 4000
RNG = np.random.default_rng(4)


def path(t):
    return 1e-6 * np.round((0.05 * np.sin(2.0 * t) + 0.02 * np.sin(5.0 * t)) / 1e-6)


def mended(stamps, x, **more):
    raw = {"slide": {"position": (stamps, x), **more}}
    notes = timed(raw, "run")
    return raw["slide"], notes


@pytest.mark.parametrize("share", [0.05, 0.2, 0.4])
def test_stamps_of_a_busy_logger_are_put_on_the_clock_that_sampled(share):
    t = PERIOD * np.arange(N)
    late = t + share * PERIOD * RNG.uniform(-1.0, 1.0, N)
    found, notes = mended(late, path(t), effort=(late, np.cos(t)))
    assert "even clock" in notes[0]
    assert np.abs(found["position"][0] - t).max() < 0.05 * PERIOD
    assert np.array_equal(found["effort"][0], found["position"][0])


def test_periods_that_were_missed_stay_missed():
    kept = np.delete(np.arange(N), [1000, 2000, 2001])
    t = PERIOD * kept
    found, _ = mended(t + 0.2 * PERIOD * RNG.uniform(-1.0, 1.0, len(t)), path(t))
    assert np.abs(found["position"][0] - t).max() < 0.05 * PERIOD


def test_samples_that_were_taken_unevenly_keep_their_stamps():
    t = PERIOD * np.arange(N) + 0.3 * PERIOD * RNG.uniform(-1.0, 1.0, N)
    found, notes = mended(t, path(t))
    assert not notes and np.array_equal(found["position"][0], t)


def test_rest_a_coarse_encoder_and_another_clock_tell_nothing():
    t = PERIOD * np.arange(N)
    late = t + 0.3 * PERIOD * RNG.uniform(-1.0, 1.0, N)
    other = late[::2] + 0.1 * PERIOD
    found, notes = mended(late, np.zeros(N), effort=(other, np.zeros(N // 2)))
    assert not notes and np.array_equal(found["position"][0], late)
    found, _ = mended(late, path(t), effort=(other, np.zeros(N // 2)))
    assert np.array_equal(found["effort"][0], other)
    assert not mended(late, 0.01 * np.round(path(t) / 0.01))[1]
