"""The cooperative law: zero at zero force, linear beyond the dead band, in the right frame, stopped by bad inputs."""

import math

import law_bench
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_bench import PARAMETERS, ROBOT, SETTINGS, LawBench
from sher3_common.reasons import Reason
from sher3_common.vectors import ZERO_TWIST, ZERO_WRENCH
from sher3_control import AxisLock, ControlSettings
from sher3_control.law.admittance import requested_twist
from sher3_control.law.parameters import law_parameters

finite = st.floats(-10.0, 10.0)
vector = st.tuples(finite, finite, finite)


def test_no_force_no_motion():
    bench = LawBench()
    bench.arm()
    assert all(out.twist == ZERO_TWIST and out.reason is Reason.MOVING for out in bench.run(200, travel=1.0))


def test_steady_velocity_is_gain_times_force_beyond_the_deadband():
    bench = LawBench()
    bench.arm()
    out = bench.run(1000, travel=1.0, force=(2.0, 0.0, 0.0), torque=(0.0, 0.06, 0.0))[-1]
    a = SETTINGS.admittance
    assert out.twist[0] == pytest.approx(a.linear_gain * (2.0 - a.force_deadband), rel=1e-4)
    assert out.twist[4] == pytest.approx(a.angular_gain * (0.06 - a.torque_deadband), rel=1e-3)
    others = (*out.twist[1:4], out.twist[5])
    assert others == pytest.approx((0.0,) * 4, abs=1e-6)


def test_the_torque_at_the_tip_counts_not_the_one_at_the_sensor():
    """A force at the tip has no moment there though the sensor, 30 mm away, reads one (contract section 3)."""
    bench = LawBench()
    bench.arm()
    out = bench.run(500, travel=1.0, force=(1.0, 0.0, 0.0))[-1]
    assert bench.state.wrench[4] == pytest.approx(-0.03, abs=1e-5)
    assert np.abs(out.twist[3:]).max() < 1e-9
    assert out.wrench[3:] == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)


def test_velocity_is_turned_from_tool_to_base_and_the_weight_leaves_no_trace():
    roll, tilt = 0.4, -0.7
    rotation = np.array(
        [[1, 0, 0], [0, math.cos(roll), -math.sin(roll)], [0, math.sin(roll), math.cos(roll)]]
    ) @ np.array([[math.cos(tilt), 0, math.sin(tilt)], [0, 1, 0], [-math.sin(tilt), 0, math.cos(tilt)]])
    weight = rotation.T @ np.array([0.0, 0.0, -PARAMETERS.tool_mass * 9.81])
    load = np.concatenate([weight, np.cross(PARAMETERS.tool_com, weight)])
    push = np.array([0.0, 0.0, 1.5])
    bench = LawBench()
    bench.arm()
    for k in range(800):
        wrench = tuple(load + np.concatenate([push, np.zeros(3)]) + 1e-7 * (k % 5))
        out = bench.tick(travel=1.0, roll=roll, tilt=tilt, wrench=wrench)
    expected = rotation @ (SETTINGS.admittance.linear_gain * (push - [0, 0, SETTINGS.admittance.force_deadband]))
    assert out.twist[:3] == pytest.approx(expected, rel=1e-4, abs=1e-7)


@given(vector, vector, st.floats(0.0, 1.0))
@settings(max_examples=200, deadline=None)
def test_request_is_bounded_by_gain_times_force_and_capped_along_its_direction(force, torque, factor):
    a = SETTINGS.admittance
    free = PARAMETERS._replace(linear_limit=math.inf, angular_limit=math.inf)
    gains = (a.linear_gain * factor, a.angular_gain * factor)
    full = np.array(requested_twist(force + torque, *gains, 0, free))
    limited = np.array(requested_twist(force + torque, *gains, 0, PARAMETERS))
    assert np.all(np.abs(full[:3]) <= gains[0] * np.abs(force))
    assert np.all(np.abs(full[3:]) <= gains[1] * np.abs(torque))
    assert np.linalg.norm(limited[:3]) <= a.linear_limit * (1 + 1e-12)
    assert np.linalg.norm(limited[3:]) <= a.angular_limit * (1 + 1e-12)
    square = full @ full
    scale = limited @ full / square if square > 0.0 else 1.0
    assert 0.0 <= scale <= 1.0 + 1e-12
    assert limited == pytest.approx(scale * full, abs=1e-15)


@given(finite, finite, st.integers(0, 5))
def test_request_is_monotone_in_every_axis(low, high, axis):
    low, high = sorted((low, high))
    free = PARAMETERS._replace(linear_limit=math.inf, angular_limit=math.inf)
    values = [
        requested_twist(tuple(x if i == axis else 0.0 for i in range(6)), 1e-3, 5.0, 0, free)[axis] for x in (low, high)
    ]
    assert values[0] <= values[1]


def test_request_is_continuous_where_motion_begins():
    edge = SETTINGS.admittance.force_deadband
    below = requested_twist((edge, 0.0, 0.0, 0.0, 0.0, 0.0), 1e-3, 5.0, 0, PARAMETERS)[0]
    above = requested_twist((edge * (1 + 1e-9), 0.0, 0.0, 0.0, 0.0, 0.0), 1e-3, 5.0, 0, PARAMETERS)[0]
    assert below == 0.0
    assert 0.0 < above < 1e-12


@pytest.mark.parametrize(
    ("lock", "kept"),
    [
        (AxisLock.FREE, (1, 1, 1, 1, 1, 1)),
        (AxisLock.TRANSLATE, (1, 1, 1, 0, 0, 0)),
        (AxisLock.ROTATE, (0, 0, 0, 1, 1, 1)),
        (AxisLock.NEEDLE, (0, 0, 1, 0, 0, 0)),
    ],
)
def test_axis_locks(lock, kept):
    twist = requested_twist((1.0, 1.0, 1.0, 0.01, 0.01, 0.01), 1e-4, 1.0, lock, PARAMETERS)
    assert tuple(int(x != 0.0) for x in twist) == kept


BAD = {
    Reason.WRENCH_NOT_FINITE: {"wrench": (0.0, 0.0, math.nan, 0.0, 0.0, 0.0)},
    Reason.WRENCH_OUT_OF_RANGE: {"wrench": (12.1, 0.0, 0.0, 0.0, 0.0, 0.0)},
    Reason.WRENCH_SATURATED: {"wrench": (0.0, 0.0, 0.0, 0.0, 0.119, 0.0)},
    Reason.WRENCH_STALE: {"wrench_stamp": law_bench.START},
    Reason.WRENCH_MISSING: {"wrench_stamp": -1},
    Reason.PEDAL_STALE: {"pedal_stamp": law_bench.START},
    Reason.PEDAL_MISSING: {"pedal_stamp": -1},
    Reason.PEDAL_INVALID: {"travel": math.nan},
    Reason.PEDAL_RELEASED: {"travel": 0.0},
    Reason.EMERGENCY_STOP: {"emergency": True},
    Reason.JOINTS_STALE: {"joints_stamp": law_bench.START},
    Reason.JOINTS_MISSING: {"joints_stamp": -1},
    Reason.JOINTS_NOT_FINITE: {"roll": math.nan},
    Reason.NOT_ENABLED: {"enabled": False},
    Reason.NOT_OWNER: {"owner": False},
    Reason.CLOCK: {"wrench_stamp": law_bench.START + 10**12},
}

NO_FORCE = [reason for reason, changes in BAD.items() if "wrench" in changes]


@pytest.mark.parametrize("reason", BAD)
def test_every_bad_input_stops_in_the_same_tick_and_needs_release_then_press(reason):
    bench = LawBench()
    bench.arm()
    moving = bench.run(100, travel=1.0, force=(3.0, 0.0, 0.0))[-1]
    assert moving.twist[0] > 1e-4
    changes = {"travel": 1.0, **BAD[reason]}
    out = bench.tick(**changes) if "wrench" in changes else bench.tick(force=(3.0, 0.0, 0.0), **changes)
    assert (out.twist, out.reason) == (ZERO_TWIST, reason)
    if reason is not Reason.PEDAL_RELEASED:
        held = bench.run(50, travel=1.0, force=(3.0, 0.0, 0.0))
        assert {o.reason for o in held} == {Reason.NOT_REARMED}
        assert all(o.twist == ZERO_TWIST for o in held)
    bench.arm()
    assert bench.run(100, travel=1.0, force=(3.0, 0.0, 0.0))[-1].twist[0] > 1e-4


@given(st.integers(0, 5), st.sampled_from([math.nan, math.inf, -math.inf, 1e300]))
@settings(deadline=None)
def test_no_wrench_field_that_is_no_force_ever_moves_the_robot(axis, value):
    bench = LawBench()
    bench.arm()
    bench.run(20, travel=1.0, force=(3.0, 0.0, 0.0))
    wrench = tuple(value if i == axis else 0.01 for i in range(6))
    out = bench.tick(travel=1.0, wrench=wrench)
    assert out.twist == ZERO_TWIST
    assert out.reason in (Reason.WRENCH_NOT_FINITE, Reason.WRENCH_OUT_OF_RANGE)


def test_frozen_wrench_is_seen_after_the_stated_number_of_samples():
    bench = LawBench()
    bench.arm()
    stuck = (3.0, 0.0, -0.2, 0.0, 0.0, 0.0)
    reasons = [bench.tick(travel=1.0, wrench=stuck).reason for _ in range(SETTINGS.wrench.frozen_samples + 5)]
    assert reasons.index(Reason.WRENCH_FROZEN) == SETTINGS.wrench.frozen_samples - 1
    assert set(reasons[SETTINGS.wrench.frozen_samples :]) == {Reason.WRENCH_FROZEN}


def test_pressed_at_start_does_not_move():
    bench = LawBench()
    assert {o.reason for o in bench.run(50, travel=1.0, force=(3.0, 0.0, 0.0))} == {Reason.NOT_REARMED}


def test_a_gap_between_ticks_is_a_stop():
    bench = LawBench()
    bench.arm()
    bench.run(50, travel=1.0, force=(3.0, 0.0, 0.0))
    bench.k += 20
    out = bench.tick(travel=1.0, force=(3.0, 0.0, 0.0))
    assert (out.twist, out.reason) == (ZERO_TWIST, Reason.CLOCK)


def test_acceleration_keeps_its_cap():
    bench = LawBench()
    bench.arm()
    outputs = bench.run(60, travel=1.0, force=(0.0, 0.0, 11.0)) + bench.run(60, travel=1.0, force=(0.0, 0.0, -11.0))
    assert max(law_bench.changes_of(outputs)) <= PARAMETERS.linear_step * (1 + 1e-9)
    assert max(law_bench.speeds(outputs)) == pytest.approx(SETTINGS.admittance.linear_limit, rel=1e-6)


def test_a_gain_jump_is_bumpless():
    bench = LawBench()
    bench.arm()
    before = bench.run(500, travel=1.0, force=(1.1, 0.0, 0.0))
    g = SETTINGS.admittance.linear_gain
    after = bench.run(600, travel=1.0, force=(1.1, 0.0, 0.0), linear_gain=2.0 * g)
    assert max(law_bench.changes_of([before[-1], *after])) <= 1.01 * g * SETTINGS.admittance.gain_rate * 0.002
    assert after[-1].twist[0] == pytest.approx(2.0 * g, rel=1e-3)


def test_speed_scale_stops_at_once_and_returns_smoothly():
    bench = LawBench()
    bench.arm()
    push = {"travel": 1.0, "force": (3.1, 0.0, 0.0)}
    bench.run(500, **push)
    stopped = bench.run(40, **push, speed_scale=0.0)
    assert bench.state.velocity == ZERO_TWIST
    back = bench.run(300, **push)
    assert max(law_bench.changes_of([stopped[-1], *back])) <= 1.01 * 0.003 * SETTINGS.admittance.scale_rate * 0.002
    assert back[-1].twist[0] == pytest.approx(0.003, rel=1e-3)


def test_binary_pedal_ignores_how_far_it_is_pressed():
    options = ControlSettings.from_robot(ROBOT, {"pedal": {"mode": "binary"}})
    ends = []
    for travel in (0.3, 1.0):
        bench = LawBench(law_parameters(ROBOT, options))
        bench.arm()
        ends.append(bench.run(500, travel=travel, force=(2.0, 0.0, 0.0))[-1].twist[0])
    assert ends[0] == ends[1] > 0.0


def test_the_step_is_pure():
    one, two = LawBench(), LawBench()
    for bench in (one, two):
        bench.arm()
    a = one.run(100, travel=0.7, force=(1.0, -2.0, 0.5))
    b = two.run(100, travel=0.7, force=(1.0, -2.0, 0.5))
    assert a == b
    assert one.state == two.state
    assert one.state.s1 != ZERO_WRENCH


event = st.tuples(st.sampled_from([0.0, 0.07, 1.0]), st.sampled_from([None, None, None, *BAD]))


@given(st.lists(event, max_size=60))
@settings(max_examples=100, deadline=None)
def test_motion_is_allowed_exactly_after_release_then_press_with_nothing_to_object_to(history):
    """Against a model of three sentences: a bad tick disarms, a released good one arms, a pressed armed one moves."""
    bench = LawBench()
    bench.k = 20
    armed = pressed = False
    for travel, bad in history:
        bad = None if bad is Reason.PEDAL_RELEASED else bad
        push = {} if bad in NO_FORCE else {"force": (3.0, 0.0, 0.0)}
        out = bench.tick(**{"travel": travel, **push, **(BAD[bad] if bad else {})})
        if bad is not None:
            armed = pressed = False
        else:
            pressed = travel > 0.05 if pressed else travel >= 0.1
            armed = armed or not pressed
        assert (out.reason is Reason.MOVING) == (bad is None and armed and pressed)
        assert out.reason is Reason.MOVING or out.twist == ZERO_TWIST
