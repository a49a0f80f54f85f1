"""Point-to-point motion: within its caps, as fast as they allow, straight, and refused where it cannot go."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from law_bench import ROBOT
from sher3_common import Sher3Error
from sher3_control.errors import TrajectoryError
from sher3_control.motion.planned.tip_move import plan_tip_move
from sher3_control.motion.planned.trajectory import double_s, plan_joint_move
from sher3_kinematics import RobotKinematics, Unreachable

KINEMATICS = RobotKinematics(ROBOT)
CAPS = (0.5 * KINEMATICS.velocity, 0.2 * KINEMATICS.acceleration, 10.0 * KINEMATICS.acceleration)
cap = st.floats(0.05, 50.0)


def sampled(profile, n=20001):
    t = np.linspace(0.0, profile.duration, n)
    s, v = np.array([profile.at(x) for x in t]).T
    return t, s, v


@given(cap, cap, cap)
def test_profile_keeps_its_caps_and_arrives(velocity, acceleration, jerk):
    profile = double_s(velocity, acceleration, jerk)
    t, s, v = sampled(profile, 401)
    a = np.diff(v) / np.diff(t)
    j = np.diff(a) / np.diff(t)[1:]
    assert (s[0], s[-1], v[0], v[-1]) == (0.0, 1.0, 0.0, 0.0)
    assert np.all(np.diff(s) >= 0.0)
    assert v.max() <= velocity * (1 + 1e-9)
    assert np.abs(a).max() <= acceleration * (1 + 1e-9)
    assert np.abs(j).max() <= jerk * (1 + 1e-6)
    assert np.abs(np.diff(s) - 0.5 * (v[1:] + v[:-1]) * np.diff(t)).max() <= 0.1 * jerk * (t[1] - t[0]) ** 3 + 1e-12


@given(cap, cap, cap)
def test_profile_is_the_fastest(velocity, acceleration, jerk):
    """It runs at one of its caps all the time: jerk, else acceleration, else velocity (Pontryagin)."""
    profile = double_s(velocity, acceleration, jerk)
    peak = profile.jerk * profile.t_jerk
    top = peak * (profile.t_acceleration - profile.t_jerk)
    coasts_in_acceleration = profile.t_acceleration > 2.0 * profile.t_jerk * (1 + 1e-9)
    coasts_in_velocity = profile.t_cruise > 1e-9 * profile.duration
    assert not coasts_in_acceleration or peak == pytest.approx(acceleration)
    assert not coasts_in_velocity or top == pytest.approx(velocity)


def test_all_axes_start_and_stop_together_within_their_caps():
    start, goal = np.zeros(5), np.array([0.004, -0.002, 0.0, 0.3, 0.005])
    move = plan_joint_move(start, goal, *CAPS)
    t = np.linspace(0.0, move.duration, 5001)
    q, v = (np.array(x) for x in zip(*(move.at(x) for x in t), strict=True))
    a = np.gradient(v, t, axis=0)
    assert np.all(np.abs(v).max(axis=0) <= CAPS[0] * (1 + 1e-9))
    assert np.all(np.abs(a).max(axis=0) <= CAPS[1] * (1 + 1e-3))
    share = np.abs(goal) / CAPS[0]
    assert np.abs(v).max(axis=0) / CAPS[0] == pytest.approx(share / share.max(), abs=1e-3)
    assert np.array_equal(q[-1], goal)
    assert np.abs(np.outer(q[:, 0], goal) - np.outer(np.ones(len(q)), goal[0]) * q).max() < 1e-15


def test_a_move_to_where_it_is_takes_no_time():
    assert plan_joint_move(np.ones(5), np.ones(5), *CAPS).duration == 0.0


def test_goals_that_are_no_numbers_are_refused():
    with pytest.raises(TrajectoryError):
        plan_joint_move(np.zeros(5), np.array([0.0, np.nan, 0.0, 0.0, 0.0]), *CAPS)


def test_the_tip_moves_on_a_straight_line_within_all_caps():
    start = np.array([0.001, 0.0, -0.001, 0.1, 0.002])
    transform = KINEMATICS.transform_tip_to_base(start)
    step, axis = np.array([0.006, -0.004, 0.003]), np.array([-0.3, 0.2, -1.0])
    move = plan_tip_move(KINEMATICS, start, transform[:3, 3] + step, axis, CAPS, 0.005, 0.3)
    t = np.linspace(0.0, move.duration, 2001)
    q, v = (np.array(x) for x in zip(*(move.at(x) for x in t), strict=True))
    poses = np.array([KINEMATICS.transform_tip_to_base(x) for x in q])
    path = poses[:, :3, 3] - transform[:3, 3]
    along = path @ step / np.linalg.norm(step)
    off_line = np.linalg.norm(path - np.outer(along, step / np.linalg.norm(step)), axis=1)
    assert off_line.max() < 1e-9
    assert path[-1] == pytest.approx(step, abs=1e-12)
    assert -poses[-1][:3, 2] == pytest.approx(axis / np.linalg.norm(axis), abs=1e-12)
    assert np.linalg.norm(np.diff(path, axis=0), axis=1).max() / (t[1] - t[0]) <= 0.005 * (1 + 1e-6)
    assert np.all(np.abs(v).max(axis=0) <= CAPS[0] * (1 + 1e-6))
    assert np.all(np.abs(np.gradient(v, t, axis=0)).max(axis=0) <= CAPS[1] * (1 + 1e-2))
    assert q[1:] - q[:-1] == pytest.approx(0.5 * (v[1:] + v[:-1]) * (t[1] - t[0]), abs=1e-7)


def test_a_tip_goal_out_of_reach_is_refused_with_a_distance():
    transform = KINEMATICS.transform_tip_to_base(np.zeros(5))
    with pytest.raises(Unreachable) as caught:
        plan_tip_move(KINEMATICS, np.zeros(5), transform[:3, 3] + [0.2, 0.0, 0.0], -transform[:3, 2], CAPS, 0.005, 0.3)
    assert isinstance(caught.value, Sher3Error)
    assert caught.value.distance > 0.0
