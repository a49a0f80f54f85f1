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


SILENT, OTHER = 1, 0


def unheard(strays=0.0, back=0.0, ticks=8):
    """Return the tick and the first trip after `SILENT` was last heard at 10 mm/s; it comes back after so many ticks.

    Args:
        strays: speed that `OTHER` adds to its command meanwhile, m/s.
        back: how far from its commands `SILENT` then is, m.
    """
    checks, log, place = MotionWatch(SCALES, SETTINGS), StopLog(), [0.0] * 5
    checks.begin()
    for k in range(-100, ticks + 1):
        silent, more = 0 <= k < ticks, strays * (k >= 0)
        checks.demand.sent([round(v / s.velocity) for v, s in zip(FAST, SCALES, strict=True)])
        checks.sync()
        place = [x + v * SETTINGS.period for x, v in zip(place, FAST, strict=True)]
        place[OTHER] += more * SETTINGS.period
        said = list(place)
        said[SILENT] = 0.0 if silent else place[SILENT] + back * (k == ticks)
        stamp = (k + 100) * 2 * MS
        feedback = DriveFeedback(stamp, tuple(said), tuple(said), tuple(FAST), (0.0,) * 5, tuple(FAST))
        trip = checks.check(feedback, Goal.ENABLED, True, log, stamp, (SILENT,) if silent else ())
        if trip is not None:
            return k + 1, trip
    return None


def test_an_axis_that_is_not_heard_is_where_its_commands_put_it():
    """Eight ticks at 10 mm/s are 160 um, and its limit is 37: it is there when it is heard again."""
    assert unheard() is None


def test_one_that_is_elsewhere_when_it_is_heard_again_is_found():
    assert unheard(back=5e-5)[1].reason is Reason.POSITION_LEFT


def test_an_axis_that_is_not_heard_shields_no_other_one():
    """7 um and 3 ms of 10 mm/s are 37 um: 10 mm/s beside the command pass them in the second tick, echo or not."""
    tick, trip = unheard(strays=1e-2)
    assert (tick, trip.reason, trip.axes) == (2, Reason.POSITION_LEFT, (OTHER,))


def test_before_the_first_whole_report_nothing_is_judged():
    checks, far = MotionWatch(SCALES, SETTINGS), (1.0,) * 5
    feedback = DriveFeedback(0, far, far, (0.0,) * 5, (0.0,) * 5, (0.0,) * 5)
    assert checks.check(feedback, Goal.DISABLED, False, StopLog(), 0, (SILENT,)) is None


@pytest.mark.parametrize("hold", [2, 6, 8, 12, 16])
def test_a_loop_held_up_at_speed_is_no_following_error(rig, hold):
    """The mock drives wait for five periods before they run on by themselves, real ones do not wait: both must do."""
    for k in range(150):
        if k % 50 == 20:
            rig.now += hold * MS
            rig.stamp += hold * MS
        rig.tick(FAST)
    assert rig.driver.stop.first is None, rig.driver.stop.first
