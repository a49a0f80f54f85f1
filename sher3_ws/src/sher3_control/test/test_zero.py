"""The zero of the force sensor: what bars arming, component by component, and what the tare and the weight explain."""

from __future__ import annotations

import numpy as np
import pytest
from law_bench import ROBOT, SETTINGS
from sher3_common.reasons import Reason
from sher3_control.law.live_parameters import live_parameters, to_json, with_bias
from sher3_control.supervision.zero import ToolContact, ZeroDetector

SENSOR = ROBOT.force_sensor
WEIGHT = SENSOR.tool_mass * 9.81
LEVEL = (0.0,) * 5
"""Load encoders where roll and tilt are zero: the weight is along -z of {f}."""
ADMITTANCE = ROBOT.admittance


def reads(force=(0.0, 0.0, 0.0), torque=(0.0, 0.0, 0.0)):
    """Return what the sensor reads of a force at the tip and a torque, with the tool on it."""
    x, y, z = SENSOR.position
    assert (x, y) == (0.0, 0.0)
    fx, fy, fz = force
    moment = (z * fy, -z * fx, 0.0)  # -(p x F), p = (0, 0, z)
    return (fx, fy, fz - WEIGHT, *(t + m for t, m in zip(torque, moment, strict=True)))


@pytest.mark.parametrize(
    ("force", "torque", "source", "value", "limit", "unit"),
    [
        ((0.0, 0.0, 0.3), (0.0,) * 3, "force sensor, force z", 0.3, 0.05, "N"),
        ((-0.06, 0.0, 0.0), (0.0,) * 3, "force sensor, force x", 0.06, 0.05, "N"),
        ((0.0,) * 3, (0.0, 0.0012, 0.0), "force sensor, torque y", 0.0012, 0.001, "N m"),
        ((0.0,) * 3, (0.0, 0.0, 0.03), "force sensor, torque z", 0.03, 0.001, "N m"),
    ],
)
def test_what_weight_and_tare_do_not_explain_bars_arming(force, torque, source, value, limit, unit):
    contact, zero = ToolContact(ROBOT), ZeroDetector(SETTINGS.tare)
    zero.rest([(0, contact.at_tip(reads(force, torque), LEVEL))] * SETTINGS.tare.arming_samples)
    found = zero.check(0)
    assert (found.reason, found.source, found.unit) == (Reason.FORCE_UNEXPLAINED, source, unit)
    assert (found.value, found.limit) == (pytest.approx(value), limit)
    assert "let go of the tool" in found.remedy and "tare with the tool hanging free" in found.remedy
    zero.begin()
    assert zero.check(0) is None, "with power the wrench is a hand's"


def test_a_zero_that_passes_is_below_the_dead_bands():
    assert SETTINGS.tare.drift_force < ADMITTANCE.force_deadband
    assert SETTINGS.tare.drift_torque < ADMITTANCE.torque_deadband


def test_the_bias_of_the_tare_explains_what_it_took():
    bias = (0.3, -0.2, 0.5, 0.004, -0.001, 0.002)
    contact, raw = ToolContact(ROBOT), tuple(np.add(reads(), (0.3, -0.2, 0.5, 0.004, -0.001, 0.002)))
    assert max(map(abs, contact.at_tip(raw, LEVEL))) > 0.4
    contact.hear(to_json(with_bias(live_parameters(SETTINGS), bias), SETTINGS))
    assert contact.at_tip(raw, LEVEL) == pytest.approx((0.0,) * 6, abs=1e-12)
    contact.hear('{"live": {}}')
    assert contact.bias == bias, "a damaged text changes nothing"


def test_the_newest_tenth_of_a_second_counts():
    zero = ZeroDetector(SETTINGS.tare)
    zero.rest([(0, (2.0, 0.0, 0.0, 0.0, 0.0, 0.0))] * 200)
    for number in range(50):
        assert zero.check(0) is not None or number >= 49
        zero.rest([(0, (0.0,) * 6)])
    assert zero.check(0) is None


def test_a_sensor_without_numbers_bars_arming():
    zero = ZeroDetector(SETTINGS.tare)
    zero.rest([(0, (float("nan"),) * 6)])
    assert zero.check(0) is not None


def test_a_sensor_that_never_speaks_in_a_tick_of_the_axes_bars_arming_and_nothing_later():
    zero = ZeroDetector(SETTINGS.tare)
    assert zero.check(0) is None, "before the first look"
    zero.rest(())
    assert zero.check(0).value == float("inf")
    zero.rest([(0, (0.0,) * 6)])
    assert zero.check(10**8) is None and zero.check(2 * 10**8).value == float("inf")
    zero.begin()
    assert zero.check(0) is None, "with power the wrench is a hand's"
