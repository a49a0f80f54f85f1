"""Ticks the loop has lost are time in which the drives went on: the watches count stamps, not calls."""

from __future__ import annotations

import pytest
from sher3_common.reasons import Reason
from sher3_description import load_robot
from sher3_drivers.canopen.cia402 import Goal
from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.settings import default_settings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.motion import MotionWatch
from sher3_drivers.watches.trips import StopLog

ROBOT = load_robot()
SETTINGS = default_settings(ROBOT.control_period)
SCALES = [AxisScale.from_actuator(actuator) for actuator in ROBOT.actuators]
FAST = [0.01, -0.01, 0.01, 0.8, -0.01]
MS = 1_000_000


def watch(lost, went=1.0, ticks=100):
    """Return the first trip of axes at speed that make the share `went` of their way; in 5 ticks `lost` are lost."""
    checks, log = MotionWatch(SCALES, SETTINGS), StopLog()
    checks.begin()
    for k in range(ticks):
        checks.demand.sent([round(v / s.velocity) for v, s in zip(FAST, SCALES, strict=True)])
        if k % 5 < lost:
            continue
        stamp = round(k * SETTINGS.period * 1e9)
        place = tuple(went * v * stamp * 1e-9 for v in FAST)
        checks.sync()
        trip = checks.check(
            DriveFeedback(stamp, place, place, tuple(FAST), (0.0,) * 5, tuple(FAST)), Goal.ENABLED, True, log, stamp
        )
        if trip is not None:
            return trip
    return None


@pytest.mark.parametrize("lost", range(5))
def test_an_axis_that_goes_on_in_lost_ticks_follows_its_demand(lost):
    assert watch(lost) is None


@pytest.mark.parametrize("lost", range(5))
def test_one_that_falls_behind_is_found_whatever_is_lost(lost):
    trip = watch(lost, went=0.7)
    assert trip is not None and trip.reason is Reason.POSITION_LEFT


@pytest.mark.parametrize("hold", [2, 6, 8, 12, 16])
def test_a_loop_held_up_at_speed_is_no_following_error(rig, hold):
    """The mock drives wait for five periods before they run on by themselves, real ones do not wait: both must do."""
    for k in range(150):
        if k % 50 == 20:
            rig.now += hold * MS
            rig.stamp += hold * MS
        rig.tick(FAST)
    assert rig.driver.stop.first is None, rig.driver.stop.first
