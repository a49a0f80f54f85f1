"""Along one way of the axes the sum of sensor and drives is compared with its begin."""

from __future__ import annotations

import numpy as np
import pytest
from sher3_control.supervision.one_way import PLAY, TURN, OneWay

STEP, LAG, MEMORY = 0.002, 0.8, 2.0
UP = np.array([0.0, 0.0, 1.0, 0.0, 0.0])
ALL = np.ones(5)
NONE = np.zeros(5)


@pytest.fixture
def way():
    return OneWay(LAG, MEMORY)


def go(way, seconds, felt, held, begin=NONE, speed=1e-4, moves=True):
    """Go at a speed of all axes; return where they end, and along z [N] the change of sum and hand and what came."""
    joints, change = begin, np.zeros((3, 5))
    for _ in range(round(seconds / STEP)):
        joints = joints + speed * STEP * ALL
        change = way.follow(STEP, felt * UP, -held * UP, joints, moves)
    return joints, change[:, 2]


def test_what_was_there_at_the_begin_of_a_way_cancels(way):
    """A weight of 0.2 N that the robot file does not know."""
    _, change = go(way, 5.0, 1.2, 1.0)
    assert np.abs(change).max() < 1e-9


def test_a_change_along_a_way_is_told_behind_its_low_pass(way):
    """0.1 N behind 0.8 s are 0.1 (1 - exp(-1.6/0.8)) = 0.086 N after 1.6 s."""
    joints, _ = go(way, 2.0, 1.0, 1.0)
    _, change = go(way, 1.6, 1.1, 1.0, joints)
    assert change == pytest.approx([0.0865, 0.0, 0.0], abs=1e-3)


def test_a_hand_that_both_feel_counts_as_a_hand(way):
    joints, _ = go(way, 2.0, 1.0, 1.0)
    _, change = go(way, 8.0, 3.0, 3.0, joints)
    assert change == pytest.approx([0.0, -2.0, 0.0], abs=1e-3)


def test_a_hand_that_comes_as_a_way_begins_is_told_beside(way):
    """2 N that the drives feel 16 ms before the sensor does: in the first mean it is 2 N times 0.016 s over 0.8 s."""
    joints, _ = go(way, 2.0, 0.0, 0.0)
    joints, _ = go(way, STEP, 0.0, 0.0, joints - 2.0 * PLAY, speed=0.0)
    joints, _ = go(way, 0.016, 0.0, 2.0, joints, speed=-1e-4)
    _, (change, _, came) = go(way, 3.0, 2.0, 2.0, joints, speed=-1e-4)
    assert came == pytest.approx(-2.0 * (1.0 - np.exp(-1.0)), rel=0.02)
    assert 0.3 < change / (0.016 / LAG * -came) < 1.0, "the oldest part of the mean is what is forgotten first"
    _, (*_, came) = go(way, 10.0, 2.0, 2.0, joints, speed=0.0, moves=False)
    _, (*_, came) = go(way, STEP, 2.0, 2.0, joints, speed=0.0)
    assert abs(came) < 0.02, "what came is forgotten with the mean, while nothing moves"


def test_an_axis_that_turns_round_begins_a_new_way(way):
    """Friction in the screws changes its sign then; a tremor of less than the play is no turning round."""
    joints, _ = go(way, 2.0, 1.0, 1.0)
    shaken = joints - 0.5 * PLAY
    _, change = go(way, 2.0, 1.1, 1.0, shaken, speed=0.0)
    assert change[0] > 0.08
    _, change = go(way, 4.0, 1.1, 1.0, joints, speed=-1e-4)
    assert abs(change[0]) < 0.04, "what is left of the low pass at the begin of the new way"


@pytest.mark.parametrize("axis", [3, 4])
def test_a_tool_that_turns_begins_a_new_way(way, axis):
    joints, _ = go(way, 2.0, 1.0, 1.0)
    turned = joints + 1.1 * TURN[axis] * np.eye(5)[axis]
    _, change = go(way, 0.5, 1.1, 1.0, turned)
    assert change[0] == 0.0


def test_what_changes_while_nothing_moves_is_forgotten(way):
    """A sensor that warms up, for 20 s and ten memories."""
    joints, _ = go(way, 2.0, 0.0, 0.0, speed=0.0)
    _, change = go(way, 20.0, 0.2, 0.0, joints, speed=0.0, moves=False)
    assert change[0] == 0.0
    _, change = go(way, 0.1, 0.2, 0.0, joints)
    assert abs(change[0]) < 1e-4
