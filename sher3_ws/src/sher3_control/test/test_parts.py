"""Filter, pedal, limits, host law and settings, one by one."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sher3_control import ControlSettings, position_commands
from sher3_control.errors import SettingsError
from sher3_control.law.limits import approach, limit_change, limit_twist
from sher3_control.law.low_pass import design_low_pass, low_pass_step
from sher3_control.law.pedal import pedal_factor, pedal_pressed
from sher3_control.law.position_controller import position_command
from sher3_description import load_robot

ROBOT = load_robot()

six = st.tuples(*[st.floats(-10.0, 10.0)] * 6)


@pytest.mark.parametrize("period", [0.005, 0.002, 0.001])
def test_cutoff_is_the_half_power_frequency_and_the_lag_is_the_measured_one(period):
    f = design_low_pass(10.0, period)
    assert abs(f.response(0.0)) == pytest.approx(1.0)
    assert abs(f.response(10.0)) == pytest.approx(math.sqrt(0.5))
    n, frequency = round(4.0 / period), 3.0
    t = np.arange(n) * period
    s1 = s2 = 0.0
    out = np.empty(n)
    for k, x in enumerate(np.sin(2 * np.pi * frequency * t)):
        out[k], s1, s2 = low_pass_step(f, x, s1, s2)
    tail = t > 2.0
    basis = np.stack([np.sin(2 * np.pi * frequency * t), np.cos(2 * np.pi * frequency * t)], axis=1)[tail]
    a, b = np.linalg.lstsq(basis, out[tail], rcond=None)[0]
    assert -math.atan2(b, a) == pytest.approx(f.phase_lag(frequency), abs=1e-6)
    assert f.delay() == pytest.approx(math.sqrt(2.0) / (2 * math.pi * 10.0), rel=0.01)


def test_pedal_has_hysteresis():
    assert not pedal_pressed(0.07, False, 0.1, 0.05)
    assert pedal_pressed(0.07, True, 0.1, 0.05)
    assert not pedal_pressed(0.05, True, 0.1, 0.05)
    assert pedal_pressed(0.1, False, 0.1, 0.05)


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_pedal_factor_is_monotone_and_reaches_from_zero_to_one(a, b):
    low, high = sorted((a, b))
    values = [pedal_factor(x, pedal_pressed(x, True, 0.1, 0.05), 0.05, False) for x in (low, high)]
    assert 0.0 <= values[0] <= values[1] <= 1.0
    assert pedal_factor(1.0, True, 0.05, False) == pytest.approx(1.0)
    assert pedal_factor(0.0, False, 0.05, False) == 0.0


@given(six, six)
def test_limited_twist_and_change_keep_their_direction(twist, previous):
    limited = np.array(limit_twist(twist, 0.5, 0.3))
    assert np.linalg.norm(limited[:3]) <= 0.5 * (1 + 1e-12)
    assert np.linalg.norm(limited[3:]) <= 0.3 * (1 + 1e-12)
    assert np.outer(limited, twist) == pytest.approx(np.outer(twist, limited), abs=1e-12)
    change = np.array(limit_change(twist, previous, 0.5, 0.3)) - previous
    wanted = np.subtract(twist, previous)
    assert np.linalg.norm(change[:3]) <= 0.5 * (1 + 1e-9)
    assert np.linalg.norm(change[3:]) <= 0.3 * (1 + 1e-9)
    assert np.outer(change, wanted) == pytest.approx(np.outer(wanted, change), abs=1e-9)


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(1e-3, 1), st.floats(1e-3, 1))
def test_approach_lands_on_its_target(value, target, rise, fall):
    for _ in range(int(2 / min(rise, fall)) + 2):
        new = approach(value, target, rise, fall)
        assert -fall * (1 + 1e-9) <= new - value <= rise * (1 + 1e-9)
        value = new
    assert value == target


def test_host_law_clamps_each_axis_and_equals_its_array_form_bit_for_bit():
    rng = np.random.default_rng(1)
    limit = np.array([a.limits.velocity for a in ROBOT.actuators])
    q_ref, q = rng.normal(0.0, 0.01, (2, 1000, 5))
    qd_ref = rng.normal(0.0, 0.01, (1000, 5))
    whole = position_commands(q_ref, qd_ref, q, ROBOT.position_gain, limit)
    lone = [
        position_command(tuple(a), tuple(b), tuple(c), ROBOT.position_gain, tuple(limit))
        for a, b, c in zip(q_ref.tolist(), qd_ref.tolist(), q.tolist(), strict=True)
    ]
    assert whole.tobytes() == np.array(lone).tobytes()
    assert np.all(np.abs(whole) <= limit)
    assert np.any(np.abs(whole) == limit)
    expected = np.clip(qd_ref + 20.0 * (q_ref - q), -limit, limit)
    assert whole.tobytes() == expected.tobytes()


@pytest.mark.parametrize(
    ("overrides", "word"),
    [
        ({"pedal": {"press": 0.01}}, "press"),
        ({"pedal": {"release": math.nan}}, "release"),
        ({"admittance": {"filter_cutoff": 220.0}}, "filter_cutoff"),
        ({"admittance": {"filter_cutoff": -1.0}}, "filter_cutoff"),
        ({"admittance": {"linear_gian": 1.0}}, "linear_gian"),
        ({"admittance": 3}, "admittance"),
        ({"nonsense": {}}, "nonsense"),
        ({"wrench": {"frozen_samples": 1}}, "frozen_samples"),
    ],
)
def test_bad_settings_are_refused_by_name(overrides, word):
    with pytest.raises(SettingsError, match=word) as caught:
        ControlSettings.from_robot(ROBOT, overrides)
    assert caught.value.remedy


def test_settings_start_from_the_robot():
    a = ControlSettings.from_robot(ROBOT, {"admittance": {"linear_gain": 0.002}}).admittance
    assert (a.linear_gain, a.angular_gain) == (0.002, ROBOT.admittance.angular_gain)
