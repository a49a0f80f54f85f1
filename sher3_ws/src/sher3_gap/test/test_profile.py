"""Blends of moves and speeds, by the closed form of the minimum-jerk quintic."""

import numpy as np
import pytest
from sher3_gap.excitation.profile import (
    Move,
    SpeedChange,
    move_track,
    shortest_move,
    shortest_speed_change,
    speed_track,
)


def test_a_move_is_half_done_at_half_time_at_its_peak_speed():
    q, v = move_track(np.array([0.0, 1.0, 2.0, 3.0]), [Move(start=1.0, duration=2.0, distance=0.4)])
    np.testing.assert_allclose(q, [0.0, 0.0, 0.2, 0.4])
    np.testing.assert_allclose(v, [0.0, 0.0, 1.875 * 0.4 / 2.0, 0.0])


def test_moves_add_up():
    moves = [Move(0.0, 1.0, 0.3), Move(2.0, 1.0, -0.1)]
    assert move_track(np.array([5.0]), moves)[0][0] == pytest.approx(0.2)


def test_the_shortest_move_keeps_whichever_limit_is_nearer():
    assert shortest_move(-2.0, velocity=1.0, acceleration=1e9) == pytest.approx(3.75)
    assert shortest_move(1.0, velocity=1e9, acceleration=10.0 / np.sqrt(3.0)) == pytest.approx(1.0)
    assert shortest_speed_change(-0.2, acceleration=3.0) == pytest.approx(0.125)


def test_a_changed_speed_travels_half_of_it_while_it_changes():
    q, v = speed_track(np.array([0.0, 2.0, 3.0]), [SpeedChange(start=0.0, duration=2.0, step=1.0)])
    np.testing.assert_allclose(v, [0.0, 1.0, 1.0])
    np.testing.assert_allclose(q, [0.0, 1.0, 2.0])
