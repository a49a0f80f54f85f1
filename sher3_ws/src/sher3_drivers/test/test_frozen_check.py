"""A report that stands while the axis was told to go; one that changes by a bit, or an axis at rest, is no offence."""

from __future__ import annotations

from sher3_common.reasons import Reason
from sher3_description import load_robot
from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.settings import default_settings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.frozen import FrozenCheck

ROBOT = load_robot()
SCALES = [AxisScale.from_actuator(actuator) for actuator in ROBOT.actuators]
SETTINGS = default_settings(ROBOT.control_period)


def run(speed, ticks, effort=lambda k: 0.0):
    """Return the first trip of a drive whose encoders stand, and its tick."""
    check, still = FrozenCheck(SCALES, SETTINGS), (0.0,) * 5
    for k in range(ticks):
        feedback = DriveFeedback(k, still, still, still, (effort(k),) * 5, still)
        if trip := check.check(feedback, (speed,) * 5, SETTINGS.period):
            return trip, k
    return None, ticks


def test_a_report_that_stands_is_found_after_the_distance_of_the_encoder_check():
    trip, tick = run(0.5e-3, 100)
    assert trip is not None and trip.reason is Reason.ENCODER_FROZEN
    assert tick == 1 + SETTINGS.encoder_distance / 0.5e-3 / SETTINGS.period // 1


def test_an_axis_held_by_friction_pushes():
    assert run(0.5e-3, 500, effort=lambda k: 0.08 * k)[0] is None


def test_at_rest_nothing_has_to_change():
    assert run(0.0, 5000)[0] is None


def test_a_standing_report_makes_the_driver_blind_until_it_starts_afresh():
    check, still = FrozenCheck(SCALES, SETTINGS), (0.0,) * 5
    feedback = DriveFeedback(0, still, still, still, still, still)
    for _ in range(20):
        check.check(feedback, (5e-3,) * 5, SETTINGS.period)
    assert check.blind
    check.begin()
    assert not check.blind
