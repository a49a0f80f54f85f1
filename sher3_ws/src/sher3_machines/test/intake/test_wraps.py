"""Counters that start again are joined over their own range; what truly jumps back is left alone."""

import numpy as np
import pytest
from sher3_machines.intake.mending.wraps import TURN, joined, wrapped_over

T = np.arange(0.0, 20.0, 0.01)


@pytest.mark.parametrize("seed", range(20))
def test_a_path_is_the_same_whatever_the_range_of_its_counter(seed):
    """Drawn motions, ranges and counts: the joined path is the true one, but for where it counts from."""
    rng = np.random.default_rng(seed)
    travel, step = 10.0 ** rng.uniform(-1.0, 2.0), 10.0 ** rng.uniform(-6.0, -4.0)
    pace = 2.0 * np.pi * rng.uniform(0.05, 0.3)
    path = travel * np.sin(pace * T + rng.uniform(0.0, 6.0))
    over = float(rng.choice([0.25, 0.5])) * travel
    over = step * 2.0 ** round(np.log2(over / step))
    path = np.round(path / step) * step
    read = (path + over / 2.0) % over - over / 2.0
    found = wrapped_over(read, step, rotary=False)
    assert found == pytest.approx(over, rel=1e-6)
    left = joined(read, found)[0] - path
    assert np.ptp(left) < 1e-6 * travel


def test_a_field_of_25_radians_is_found_by_its_two_digits():
    read = (9.0 * np.sin(0.9 * T) * 2.0 + 12.5) % 25.0 - 12.5
    assert wrapped_over(read, 25.0 / 65536, rotary=True) == pytest.approx(25.0, rel=1e-9)


def test_angles_within_a_turn_are_joined_as_ever():
    read = (3.0 * T) % TURN
    assert wrapped_over(read, 1e-4, rotary=True) == TURN
    assert joined(read, TURN)[0] == pytest.approx(3.0 * T)


def test_what_goes_further_than_a_turn_does_not_start_again_within_it():
    """Steps of a position that is no angle, 0.4 to 9.6, some of them near 2 pi."""
    levels = np.random.default_rng(0).uniform(0.4, 9.6, 40)
    assert (np.abs(np.abs(np.diff(levels)) - TURN) < 0.3).any()
    assert wrapped_over(np.repeat(levels, 50), 1e-3, rotary=True) == 0.0


@pytest.mark.parametrize(
    "x",
    [
        np.sign(np.sin(T)),
        np.where(T < 10.0, 0.0, 1.0),
        np.sin(T),
        np.where(np.arange(len(T)) == 700, 50.0, np.sin(T)),
        np.zeros(len(T)),
    ],
    ids=["square", "step", "sine", "one wrong reading", "at rest"],
)
def test_what_does_not_go_on_behind_a_jump_has_not_wrapped(x):
    assert wrapped_over(x, 1e-4, rotary=False) == 0.0
