"""A clock that recorded speeds count: exact where stamps jitter about an even one, and none where they are right."""

import numpy as np
import pytest
from sher3_machines.intake.mending.counted import counted_stamps

PERIOD = 1e-3


def motion(t, seed):
    """Three joints that move at once, and their speeds."""
    rng = np.random.default_rng(seed)
    size, turns, phase = rng.uniform(0.3, 1.5, 3), rng.uniform(0.1, 0.6, 3), rng.uniform(0.0, 6.0, 3)
    angle = 2.0 * np.pi * turns * t[:, None] + phase
    return size * np.sin(angle), size * 2.0 * np.pi * turns * np.cos(angle)


def logged(seed, jitter, lost=0.05, again=0.04):
    """Whole periods between rows, and what was recorded: stamps that jitter, places, and speeds that are noisy."""
    rng = np.random.default_rng(seed)
    steps = rng.choice([0, 1, 2, 3], p=[again, 1.0 - again - lost, 0.8 * lost, 0.2 * lost], size=8000)
    true = PERIOD * np.concatenate([[0], np.cumsum(steps)])
    x, v = motion(true, seed)
    late = np.maximum.accumulate(true + jitter * PERIOD * rng.normal(size=len(true)))
    return true, late + 1e-9 * np.arange(len(true)), x, v + 1e-3 * rng.normal(size=v.shape)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("jitter", [0.2, 0.4, 1.0])
def test_periods_are_counted_where_stamps_jitter(seed, jitter):
    true, t, x, v = logged(seed, jitter)
    found = counted_stamps(t, x, v)
    assert found is not None
    assert np.std((found - true) - (found - true).mean()) < 0.02 * PERIOD * len(true) ** 0.5 * jitter


@pytest.mark.parametrize("seed", range(5))
def test_stamps_that_are_right_stay(seed):
    """Even ones, and uneven ones of a logger that stamps when it reads."""
    rng = np.random.default_rng(seed)
    for steps in (np.ones(5000), rng.uniform(0.4, 1.9, 5000)):
        t = PERIOD * np.concatenate([[0.0], np.cumsum(steps)])
        x, v = motion(t, seed)
        assert counted_stamps(t, x, v + 1e-3 * rng.normal(size=v.shape)) is None


def test_nothing_is_said_at_rest_or_of_speeds_of_another_joint():
    rng = np.random.default_rng(0)
    _, t, x, v = logged(0, 0.4)
    assert counted_stamps(t, np.zeros_like(x), np.zeros_like(v)) is None
    assert counted_stamps(t, x, rng.normal(size=v.shape)) is None
    assert counted_stamps(t[:50], x[:50], v[:50]) is None


@pytest.mark.parametrize("seed", range(3))
def test_readings_that_a_faster_log_holds_unevenly_are_counted(seed):
    """A channel of 100 Hz in rows of 1 ms, each reading held for 8 to 12 of them, with a rest in the middle."""
    rng = np.random.default_rng(seed)
    even = 10.0 * PERIOD * np.arange(1500)
    x, v = motion(np.minimum(even, 7.0) + np.maximum(even - 8.0, 0.0), seed)
    v = v * ((even < 7.0) | (even > 8.0))[:, None]
    rows = np.cumsum(rng.integers(8, 13, size=len(even)))
    at = np.searchsorted(rows, np.arange(rows[-1]), side="right")
    found = counted_stamps(PERIOD * np.arange(len(at)), x[at], v[at])
    assert found is not None
    steps = np.diff(found[found != np.roll(found, 1)])
    assert np.mean(np.abs(steps / np.median(steps) - 1.0) < 1e-6) > 0.99


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("every", [40, 150])
def test_rows_that_even_stamps_hide_are_counted(seed, every):
    """A logger that numbers its rows and is held up for 5 to 20 of them: the record takes longer than it says."""
    rng = np.random.default_rng(seed)
    steps = np.ones(4000)
    steps[every::every] = rng.integers(5, 20, size=len(steps[every::every]))
    true = PERIOD * np.concatenate([[0.0], np.cumsum(steps)])
    x, v = motion(true, seed)
    found = counted_stamps(PERIOD * np.arange(len(true)), x, v + 1e-3 * rng.normal(size=v.shape))
    assert found is not None
    assert np.abs(np.diff(found) - np.diff(true)).mean() < 0.01 * PERIOD


@pytest.mark.parametrize("seed", range(5))
def test_speeds_that_are_differences_of_the_places_say_nothing_of_the_clock(seed):
    """Of a motor that is reversed within a row, logged ten times a second, and then stands."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(0.1 + 1e-3 * rng.random(260))
    told = np.repeat(rng.uniform(5.0, 20.0, 4) * [1.0, 2.0, -2.0, 0.0], [40, 40, 45, 135])
    speed = told + np.concatenate([[0.0], 0.1 * np.diff(told)])
    x = np.concatenate([[0.0], np.cumsum(speed[1:] * np.diff(t))])
    v = np.concatenate([[0.0], np.diff(x) / np.diff(t)])
    assert counted_stamps(t, x[:, None], v[:, None]) is None
