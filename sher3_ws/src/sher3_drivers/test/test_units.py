"""Counts and SI units: exact round trips, signs, ranges."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sher3_description import load_robot
from sher3_drivers.canopen.emcy import CODES, EMCY, decode_emergency
from sher3_drivers.errors import FrameError, ScaleError
from sher3_drivers.units import AxisScale

ROBOT = load_robot()
SCALES = [AxisScale.from_actuator(actuator) for actuator in ROBOT.actuators]
axes = st.sampled_from(SCALES)
int32 = st.integers(-(2**31) + 1, 2**31 - 1)


@given(axes, int32)
def test_counts_survive_si_and_back(scale, counts):
    assert scale.velocity_counts(counts * scale.velocity) == counts
    assert scale.motor_counts(counts * scale.motor_encoder) == counts


@given(axes, st.floats(-1.0, 1.0))
def test_velocity_keeps_sign_and_is_rounded_by_half_a_count(scale, share):
    velocity = share * scale.velocity_limit
    counts = scale.velocity_counts(velocity)
    assert counts * velocity >= 0
    assert abs(counts * scale.velocity - velocity) <= 0.5000001 * scale.velocity


@pytest.mark.parametrize("scale", SCALES, ids=lambda scale: scale.name)
def test_velocity_rounding_moves_nothing_measurable_in_ten_minutes(scale):
    assert 0.5 * scale.velocity * 600.0 < 0.1 * scale.load_encoder


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e9])
def test_what_does_not_fit_is_refused(value):
    for convert in (SCALES[0].velocity_counts, SCALES[0].motor_counts):
        with pytest.raises(ScaleError, match="delta_1"):
            convert(value)


def test_encoder_increments_are_the_real_encoders():
    assert [scale.load_increments for scale in SCALES] == [819200, 819200, 819200, 262144, 819200]
    assert {scale.motor_increments for scale in SCALES} == {200000}


def test_an_encoder_that_is_no_whole_number_of_increments_is_refused():
    actuator = ROBOT.actuators[0].model_copy(update={"motor_encoder": 1.0000123e-6})
    with pytest.raises(ScaleError, match="motor_encoder"):
        AxisScale.from_actuator(actuator)


def test_a_velocity_limit_beyond_the_object_is_refused():
    limits = ROBOT.actuators[0].limits.model_copy(update={"velocity": 0.08})
    with pytest.raises(ScaleError, match="velocity limit"):
        AxisScale.from_actuator(ROBOT.actuators[0].model_copy(update={"limits": limits}))


@pytest.mark.parametrize("code", list(CODES))
def test_every_emergency_code_has_a_sentence(code):
    emergency = decode_emergency(EMCY.pack(code, 0x11, b"abcde"))
    assert emergency.code == code and emergency.text == CODES[code]
    assert emergency.is_reset == (code == 0)


@given(st.integers(0, 0xFFFF))
def test_unknown_codes_name_their_family(code):
    assert decode_emergency(EMCY.pack(code, 0, bytes(5))).text


def test_a_short_emergency_is_refused():
    with pytest.raises(FrameError):
        decode_emergency(b"\x00")
