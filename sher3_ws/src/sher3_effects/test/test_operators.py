"""Operators of hysteresis and lag, by numbers worked out by hand."""

import numpy as np
import pytest
from sher3_effects.operators import (
    dahl,
    dahl_turned,
    first_order,
    flight,
    held_lag,
    oscillator,
    play,
    rate_limited,
    released_play,
    second_difference,
    sheath,
)


def test_dahl_rises_by_the_distance_over_its_displacement():
    state = dahl(np.array([0.0, 1.0, 3.0]), 2.0)
    np.testing.assert_allclose(state, [0.0, 1 - np.exp(-0.5), 1 - np.exp(-1.5)])


def test_dahl_turns_with_the_direction():
    state = dahl(np.array([0.0, 100.0, 99.0]), 1.0)
    assert state[1] == pytest.approx(1.0)
    assert state[2] == pytest.approx(-1.0 + 2.0 * np.exp(-1.0))


def test_a_path_that_turns_between_samples_is_followed_to_where_it_rests():
    """Speeds 1 and -1 m/s, 2 s apart: it goes on by 1/2 * 2 * 1 / 2 = 0.5 m and comes back."""
    state = dahl_turned(np.array([0.0, 0.0]), np.array([1.0, -1.0]), 1.0, 2.0)
    there = 1.0 - np.exp(-0.5)
    assert state[1] == pytest.approx(-1.0 + (1.0 + there) * np.exp(-0.5))


def test_a_sheath_holds_back_a_share_of_the_wrap_in_each_piece():
    """The tension doubles at the beginning: a wrap of 1 in four pieces lets it fall by 0.25 from piece to piece."""
    log = sheath(np.array([0.0, np.log(2.0)]), 1.0, 4)
    np.testing.assert_allclose(log[0], 0.0)
    np.testing.assert_allclose(log[1], [np.log(2.0) - 0.25, np.log(2.0) - 0.5, 0.0, 0.0], atol=1e-12)


def test_play_stays_until_a_flank_takes_it():
    follower = np.array([0.0, 1.0, 2.0, 1.5, -1.0]) + play(np.array([0.0, 1.0, 2.0, 1.5, -1.0]), 2.0)
    np.testing.assert_allclose(follower, [0.0, 0.0, 1.0, 1.0, 0.0])


def test_play_begins_where_it_is_told():
    assert play(np.array([0.0]), 2.0, 1.0)[0] == pytest.approx(1.0)


def test_a_load_crosses_a_gap_that_nobody_moves():
    """2 N against 4 N s/m: 0.5 m/s, 0.05 m in each tick of 0.1 s, until the flank at 0.1 m."""
    still, drive = np.zeros(4), np.full(4, 2.0)
    np.testing.assert_allclose(released_play(still, drive, still, 0.0, 0.2, 4.0, 0.1, 0.0), [0.05, 0.1, 0.1, 0.1])


def test_a_mass_flies_on_when_its_flank_stops():
    path = np.array([0.0, 1.0, 2.0, 2.0, 2.0])
    follower = path + flight(path, 1.0, 0.0, 1.0, -1.0)
    np.testing.assert_allclose(follower, [-0.5, 0.5, 1.5, 2.5, 2.5])


def test_an_oscillator_settles_at_its_input():
    force = np.vstack([np.zeros((1, 1)), np.ones((4000, 1))])
    swing = oscillator(force, 5.0, 0.1, 0.002)
    assert swing[-1, 0] == pytest.approx(1.0, abs=1e-3)
    assert swing.max() == pytest.approx(1.0 + np.exp(-np.pi * 0.1 / np.sqrt(1 - 0.01)), abs=2e-3)


def test_a_lag_is_exact_for_a_held_input_and_for_a_ramp():
    step = held_lag(np.array([[0.0], [1.0], [1.0]]), 1.0, 0.5)
    np.testing.assert_allclose(step[:, 0], [0.0, 0.0, 1.0 - np.exp(-0.5)])
    time = 0.1 * np.arange(200)
    lagged = first_order(time - 0.1, time - 0.05, time, 0.5, 0.1)
    assert time[-1] - lagged[-1] == pytest.approx(0.5, abs=1e-6)


def test_a_top_speed_bounds_each_step():
    path = rate_limited(np.array([0.0, 10.0, 10.0, 10.0]), 0.0, 2.0, 0.1, 0.5)
    np.testing.assert_allclose(path, [0.0, 0.0, 1.0, 2.0])


def test_the_second_difference_of_a_parabola_is_its_acceleration():
    time = 0.01 * np.arange(6)
    np.testing.assert_allclose(second_difference(1.5 * time**2, 0.01)[1:-1], 3.0)
