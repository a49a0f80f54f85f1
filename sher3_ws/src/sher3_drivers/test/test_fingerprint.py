"""Stale and swapped reports by their echo, and an encoder that drifts, with numbers by hand."""

from __future__ import annotations

import math

import pytest
from sher3_common.reasons import Reason
from sher3_description import load_robot
from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.settings import default_settings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.fingerprint import FingerprintCheck
from sher3_drivers.watches.joints import JointWatch

ROBOT = load_robot()
SCALES = [AxisScale.from_actuator(actuator) for actuator in ROBOT.actuators]
SETTINGS = default_settings(ROBOT.control_period)


def commands(tick):
    """Return five velocities that no other tick and no other axis has."""
    return tuple([1e-4 * (1 + axis) * math.sin(0.05 * tick + axis) for axis in range(5)])


def run(echo, ticks=60, command=commands):
    """Return the first trip and its tick; `echo(k)` is what the drives say at tick k, `command(k)` what they held."""
    check = FingerprintCheck(SCALES, SETTINGS)
    for tick in range(ticks):
        check.sync(command(tick))
        if trip := check.check(echo(tick)):
            return trip, tick
    return None, ticks


def test_a_report_of_its_own_tick_and_axis_is_believed():
    assert run(commands, 1000)[0] is None


@pytest.mark.parametrize("late", [1, 2, 3, 15])
def test_a_report_that_is_late_forever_is_found_with_the_fourth(late):
    trip, tick = run(lambda k: commands(k - late) if k >= 20 else commands(k))
    assert trip.reason is Reason.FEEDBACK_STALE and tick == 23
    assert f"{late} ticks ago" in trip.text


def test_one_that_is_late_now_and_then_is_none():
    assert run(lambda k: commands(k - 1) if k % 4 else commands(k), 1000)[0] is None


def test_two_swapped_axes_are_found_with_the_fourth_report():
    def swapped(k):
        a, b, *rest = commands(k)
        return (b, a, *rest) if k >= 20 else (a, b, *rest)

    trip, tick = run(swapped)
    assert trip.reason is Reason.FEEDBACK_SWAPPED and tick == 23
    assert trip.text.startswith("delta_1") and "delta_2" in trip.text


def test_at_rest_nothing_is_told():
    assert run(lambda k: (0.0,) * 5, 1000, lambda k: (0.0,) * 5)[0] is None


def test_a_wrong_echo_is_the_business_of_another_check():
    assert run(lambda k: (7e-3,) * 5, 1000)[0] is None


def drift(rate, motor_rate=0.0, ticks=100_000):
    """Return where a load encoder is when its drift [m/s] is found, and the trip."""
    check = JointWatch(SCALES[:1], SETTINGS)
    for tick in range(ticks):
        motor = motor_rate * SETTINGS.period * tick
        load = motor + rate * SETTINGS.period * tick
        said = DriveFeedback(tick, (load,), (motor,), (0.0,), (0.0,), (motor_rate,))
        if trip := check.check(said, SETTINGS.period if tick else 0.0):
            return load - motor, trip
    return math.inf, None


@pytest.mark.parametrize("rate", [1e-6, 2e-5])
def test_a_load_encoder_that_drifts_at_rest_is_found_at_ten_micrometres(rate):
    """Four more ticks of 2 ms pass until the latency of 10 ms is over. It crawls: the motor repeats bit for bit."""
    way, trip = drift(rate)
    assert trip.reason in (Reason.ENCODERS_DISAGREE, Reason.ENCODER_FROZEN)
    assert 7e-6 < way <= 10e-6 + 6 * rate * SETTINGS.period


def test_one_that_drifts_while_the_axis_moves_has_two_per_cent_of_its_range():
    """At 0.5 mm/s a drift of 20 um/s is past 10 um + 2 % of the range after 10 um / (20 - 10) um/s = 1 s: 20 um."""
    way, trip = drift(2e-5, 5e-4)
    assert trip.reason is Reason.ENCODERS_DISAGREE
    assert way == pytest.approx(20e-6 + 4 * 2e-5 * SETTINGS.period, abs=1e-7)


def test_a_lead_error_of_one_per_cent_is_none():
    assert drift(1e-5, 1e-3, 20_000)[1] is None
