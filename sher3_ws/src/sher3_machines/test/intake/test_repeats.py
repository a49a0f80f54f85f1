"""Rows that a logger polled twice and channels slower than the log are told from coarse readings and from rest."""

import numpy as np
import pytest
from sher3_machines.intake.mending.motion import counts_backwards
from sher3_machines.intake.mending.repeats import filled, fresh_readings, fresh_rows, goes_smoothly, hold_of

N = 3000
CLOCK = 0.002 * np.arange(N)
PLACE = np.sin(2.0 * np.pi * 0.5 * CLOCK)
EFFORT = np.cos(2.0 * np.pi * 0.5 * CLOCK) + np.random.default_rng(0).normal(0.0, 0.02, N)


def polled(share, *columns):
    """Columns in which a share of the rows repeats the one before, and that mask."""
    again = np.random.default_rng(1).random(N) < share
    again[[0, -1]] = False
    last = np.maximum.accumulate(np.where(again, 0, np.arange(N)))
    return again, [x[last] for x in columns]


@pytest.mark.parametrize("share", [0.05, 0.3, 2.0 / 3.0])
def test_rows_that_were_polled_twice_are_no_samples(share):
    again, columns = polled(share, PLACE, EFFORT)
    assert np.mean(fresh_rows(columns) != ~again) < 0.02  # a run of more than sixteen is taken for rest


def test_a_channel_at_a_third_of_the_rate_is_held_for_three_rows():
    held = EFFORT[np.arange(N) // 3 * 3]
    fresh = fresh_readings(held)
    assert (np.flatnonzero(fresh[:-3]) % 3 == 0).all() and hold_of(fresh) == 3.0
    assert np.abs(filled(held, fresh) - EFFORT).std() < 0.03


@pytest.mark.parametrize("rows", [3, 10, 40])
def test_an_encoder_may_be_held_for_any_number_of_rows(rows):
    """Nothing moves in steps; where the axis rests a reading that stays was read again."""
    place = np.sin(np.pi * np.where(CLOCK < 2.0, CLOCK, np.maximum(2.0, CLOCK - 0.5)))  # half a second of rest
    held = place[np.arange(N) // rows * rows]
    fresh = fresh_readings(held, steps=False)
    assert hold_of(fresh) == rows
    assert np.abs(np.diff(np.flatnonzero(fresh[:-rows])) - rows).max() <= 1


def test_coarse_counts_rest_steps_and_noise_are_samples():
    coarse = np.round(PLACE / 0.02) * 0.02
    assert fresh_readings(coarse).all() and fresh_readings(coarse, steps=False).all()
    assert fresh_rows([coarse, np.round(EFFORT / 0.5)]).all()
    assert fresh_rows([np.repeat([0.0, 1.0, 0.0], 1000), np.repeat([5.0, 7.0, 5.0], 1000)]).all()  # rest and stairs
    assert fresh_readings(np.repeat([0.0, 1.0], 5)[np.arange(N) % 10]).all()  # a square wave has one step
    assert fresh_readings(np.round(EFFORT / 0.02) * 0.02).all()  # a noise of one count
    dwells = np.repeat(0.1 * np.arange(N // 10), 10) + 0.02 * np.repeat([[0, 1, 2, 3] + [4] * 6], N // 10, 0).ravel()
    assert fresh_rows([dwells, dwells]).all() and fresh_readings(dwells, steps=False).all()  # starts and stops


def test_a_reference_in_steps_is_meant_and_one_that_goes_on_is_a_path():
    assert goes_smoothly(PLACE[::3]) and not goes_smoothly(np.random.default_rng(2).normal(size=500))


def test_a_second_encoder_that_counts_backwards_is_told_by_the_motion():
    assert counts_backwards(3.0 - 0.9 * PLACE, PLACE) and not counts_backwards(0.9 * PLACE, PLACE)
    assert not counts_backwards(np.zeros(N), PLACE) and not counts_backwards(-EFFORT, PLACE)


def test_wheels_that_set_off_from_rest_were_not_polled_twice():
    """Speeds of two wheels, told to go for a second and to stop for a fifth of one, in hundredths of a rad/s."""
    going = (np.arange(N) % 60) > 10
    speeds = [np.round(np.where(going, 5.0 + side * PLACE + 0.05 * EFFORT, 0.0), 2) for side in (1.0, -1.0)]
    assert fresh_rows([*speeds, np.where(going, 5.0, 0.0)]).all()
