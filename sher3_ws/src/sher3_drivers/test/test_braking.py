"""A robot that brakes is watched from the stop to its rest, every axis in every tick, with numbers by hand.

A leg's ramp takes 1.83 m/s2 over 2 ms, 3.66 mm/s, off in a tick: 5 mm/s become 1.34 and 0, and 2 mm/s become 0 at once.
"""

from __future__ import annotations

import pytest
from sher3_common.reasons import Reason
from sher3_description import load_robot
from sher3_drivers.canopen.cia402 import Goal
from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.settings import default_settings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.motion import MotionWatch
from sher3_drivers.watches.trips import StopLog, Trip, together

SCALES = [AxisScale.from_actuator(actuator) for actuator in load_robot().actuators]
SETTINGS = default_settings()
PERIOD, STEP = SETTINGS.period, 3.66e-3
REST, LEG, ROLL, TILT = (0.0,) * 5, 0, 3, 4
EMERGENCY = Trip(Reason.DRIVE_EMERGENCY, "a drive says so")
BRAKE_TICKS = round(SETTINGS.brake_time / PERIOD)


def of(axis, value):
    return tuple([value if n == axis else 0.0 for n in range(5)])


class Robot:
    """Axes that go where they are told, and then where a test has them go."""

    def __init__(self, command=REST, effort=REST, ticks=300):
        self.watch, self.log, self.place, self.tick = MotionWatch(SCALES, SETTINGS), StopLog(), list(REST), 0
        self.watch.begin()
        for _ in range(ticks):
            assert self.follow(command, effort) is None

    def follow(self, command, effort=REST, strays=REST, motor=None):
        """Let a period pass in which drives follow `command` and go `strays` beside it; return who objects.

        `motor` is what the motor encoders say instead of the truth.
        """
        self.watch.demand.sent([round(v / scale.velocity) for v, scale in zip(command, SCALES, strict=True)])
        self.watch.sync()
        return self._look(Goal.ENABLED, tuple(map(sum, zip(command, strays, strict=True))), command, effort, motor)

    def stop(self, trip=EMERGENCY):
        self.log.add(trip, self._now)
        self.watch.rest.begin()

    def brake(self, velocity, echo=REST, effort=REST, goal=Goal.STOPPED, motor=None):
        """Let a period of a stop pass; `motor` is what the motor encoders say instead of the truth."""
        self.watch.demand.stopped()
        self.watch.sync()
        return self._look(goal, velocity, echo, effort, motor)

    @property
    def _now(self):
        return round(self.tick * PERIOD * 1e9)

    def _look(self, goal, velocity, echo, effort, motor=None):
        self.tick += 1
        self.place = [x + v * PERIOD for x, v in zip(self.place, velocity, strict=True)]
        place = tuple(self.place)
        said = DriveFeedback(self._now, place, motor or place, velocity, effort, echo)
        return self.watch.check(said, goal, goal is Goal.ENABLED, self.log, self._now)


def ramp(speed, late=0):
    """Return the speeds of a leg that brakes, tick by tick, `late` ticks after it was told to."""
    return [max(0.0, speed - STEP * max(0, k + 1 - late)) for k in range(BRAKE_TICKS + 50)]


@pytest.mark.parametrize("speed", [0.5e-3, 2e-3, 5e-3, 12.2e-3])
@pytest.mark.parametrize("late", [-10, -1, 0, 1])
@pytest.mark.parametrize("goal", [Goal.STOPPED, Goal.DISABLED])
def test_a_robot_that_brakes_is_not_accused(speed, late, goal):
    """It may have braked before it was told to, as drives do by themselves, and it may hear of it a tick later."""
    robot = Robot((speed,) * 3 + (0.0, 0.0))
    if goal is Goal.STOPPED:
        robot.stop()
    for leg in ramp(speed, late):
        velocity = (leg,) * 3 + (0.0, 0.0)
        assert robot.brake(velocity, velocity, goal=goal) is None


def travel(robot, velocity, echo=REST):
    """Return who objects to axes that go on after a stop, and how many ticks later."""
    for tick in range(1, BRAKE_TICKS):
        if trip := robot.brake(velocity, echo):
            return trip, tick
    raise AssertionError("nobody noticed")


def test_an_axis_that_goes_by_itself_while_the_robot_brakes_is_found():
    """At rest, 2 mm/s are 4 um a tick: the second one passes 7 um. Nobody waits for the end of the braking time."""
    robot = Robot()
    robot.stop()
    trip, tick = travel(robot, of(LEG, 2e-3))
    assert (trip.reason, trip.axes, tick) == (Reason.STOP_NOT_OBEYED, (LEG,), 2)
    assert robot.watch.deaf(robot.log)


def test_an_axis_that_goes_on_as_before_the_stop_is_found():
    """It goes on at 2 mm/s; its limit is 7 um and 3 ms of 2 mm/s, 13 um, and a ramp of no tick explains nothing."""
    robot = Robot(of(LEG, 2e-3))
    robot.stop()
    trip, tick = travel(robot, of(LEG, 2e-3))
    assert (trip.reason, trip.axes, tick) == (Reason.STOP_NOT_OBEYED, (LEG,), 4)


def test_one_that_is_being_disabled_is_found_too():
    robot = Robot()
    assert robot.brake(of(LEG, 2e-3), goal=Goal.DISABLED) is None
    assert robot.brake(of(LEG, 2e-3), goal=Goal.DISABLED).reason is Reason.MOVED_DISABLED


def test_an_honest_echo_tells_sooner():
    """1 um at 1 mm/s is half a tick."""
    robot = Robot()
    robot.stop()
    assert travel(robot, of(LEG, 1e-3), of(LEG, 1e-3))[1] == 1


def test_all_axes_that_move_are_accused_and_each_once():
    """The legs at 2 mm/s pass 7 um in the second tick, with the third one at 1.1 mm/s halfway there by 4.4 um; so is
    the tilt, at 0.5 mm/s from then on, after 4 more ticks."""
    robot = Robot()
    robot.stop()
    trip, _ = travel(robot, (2e-3, -2e-3, 1.1e-3, 0.0, 0.0))
    assert trip.axes == (0, 1, 2)
    trip, tick = travel(robot, (2e-3, -2e-3, 1.1e-3, 0.0, 0.5e-3))
    assert trip.axes == (0, 1, 2, TILT) and tick == 4


@pytest.mark.parametrize(("speed", "ticks"), [(0.0, 0), (2e-3, 3), (5e-3, 4), (12.2e-3, 6)])
def test_the_power_goes_when_the_ramps_are_over_and_the_drives_show_it(speed, ticks):
    """2 mm/s are 0 from the first SYNC of the stop on, 12.2 from the fourth; a command shows in its echo in 6 ms."""
    robot = Robot(of(LEG, speed))
    robot.watch.demand.stopped()
    robot.stop(Trip(Reason.POSITION_LEFT, "left", axes=(LEG,)))
    for tick in range(ticks):
        assert not robot.watch.powers_off(robot.log), tick
        robot.brake(REST)
    assert robot.watch.powers_off(robot.log)


def test_a_stop_that_holds_keeps_the_power():
    robot = Robot()
    robot.stop()
    for _ in range(BRAKE_TICKS + 5):
        robot.brake(REST)
    assert not robot.watch.powers_off(robot.log)


def test_an_axis_that_was_accused_of_the_stop_is_not_accused_again_before_the_rest():
    robot = Robot()
    robot.stop(Trip(Reason.POSITION_LEFT, "left", axes=(LEG,)))
    assert all(robot.brake(of(LEG, 2e-3)) is None for _ in range(BRAKE_TICKS - 1))
    assert [t.axes for _ in range(20) if (t := robot.brake(of(LEG, 2e-3)))] == [(LEG,)]


def test_a_departure_is_carried_over_into_the_stop():
    """6 um before the stop count as 5.25, three quarters of the limit: 2.4 um more in this direction are too many."""
    for way, found in ((1.0, True), (-1.0, False)):
        robot = Robot()
        for _ in range(5):
            assert robot.follow(REST, strays=of(LEG, 6e-4)) is None
        robot.stop()
        trips = [robot.brake(of(LEG, way * 6e-4)) for _ in range(2)]
        assert (trips[1] is not None) is found


def test_power_that_goes_while_a_hand_pulls_moves_nothing():
    """13.27 N over ki explain 100 um; when the drive has no power any more they are gone, and the axis stays."""
    robot = Robot(ticks=1)
    for tick in range(500):
        assert robot.follow(REST, of(LEG, 13.27 * tick / 500), of(LEG, -1e-4 / 500 / PERIOD)) is None
    robot.stop()
    assert all(robot.brake(REST) is None for _ in range(BRAKE_TICKS + 100))


def test_a_force_explains_60_um_of_an_axis_that_goes_on_after_a_stop():
    """At 0.45 mm/s, 0.9 um a tick, its drive reports what would explain all; in the rest 60 and 7 um take 75 ticks."""
    robot, scale = Robot(), SCALES[LEG]
    robot.stop()
    for tick in range(1, 150):
        effort = of(LEG, -scale.hold * 4.5e-4 * (tick * PERIOD + scale.settling))
        if trip := robot.brake(of(LEG, 4.5e-4), effort=effort):
            break
    assert (trip.reason, trip.axes) == (Reason.STOP_NOT_OBEYED, (LEG,)) and tick == pytest.approx(
        BRAKE_TICKS + 75, abs=2
    )


def test_a_motor_encoder_that_stands_hides_no_axis_that_goes_on_after_a_stop():
    """At 1 mm/s, 2 um a tick, the load encoder has moved by more than 7 um in the fourth tick."""
    robot = Robot()
    robot.stop()
    trips = [robot.brake(of(LEG, 1e-3), motor=REST) for _ in range(4)]
    assert trips[:3] == [None] * 3 and (trips[3].reason, trips[3].axes) == (Reason.ENCODER_FROZEN, (LEG,))


def test_all_axes_whose_load_encoders_stand_while_their_motors_go_lose_their_power_at_once():
    """At 0.5 mm/s, 1 um a tick, a motor is more than 7 um off in the eighth tick; nobody can say that it brakes."""
    robot = Robot()
    for tick in range(1, 8):
        assert robot.follow(REST, motor=(tick * 1e-6, 0.0, 0.0, 0.0, -tick * 1e-6)) is None
    trip = robot.follow(REST, motor=(8e-6, 0.0, 0.0, 0.0, -8e-6))
    assert (trip.reason, trip.axes) == (Reason.ENCODER_FROZEN, (LEG, TILT)) and trip.text.startswith("delta_1")


def test_encoders_that_differ_after_another_axis_stopped_the_robot_for_theirs_are_told():
    """The tilt was accused; a leg whose load encoder stands goes on at 1 mm/s, and is beyond 7 um in four ticks."""
    robot = Robot()
    robot.stop(Trip(Reason.ENCODERS_DISAGREE, "apart", axes=(TILT,)))
    trips = [robot.brake(REST, motor=of(LEG, tick * 2e-6)) for tick in range(1, 5)]
    assert trips[:3] == [None] * 3 and trips[3].axes == (LEG,)


def test_nothing_is_forgotten_where_the_rest_begins():
    """A creep of 0.1 mm/s is 0.2 um a tick: from the stop on it takes 36 ticks to 7 um, whenever the rest begins."""
    for ahead in (0, BRAKE_TICKS - 20, BRAKE_TICKS - 1):
        robot = Robot()
        robot.stop()
        assert all(robot.brake(REST) is None for _ in range(ahead))
        found = next(k for k in range(1, 200) if robot.brake(of(LEG, 1e-4)))
        assert found <= 36 + 3


def test_every_axis_that_moves_at_rest_is_named():
    robot = Robot()
    robot.stop()
    for _ in range(BRAKE_TICKS + 5):
        robot.brake(REST)
    assert travel(robot, (2e-3, 0.0, -2e-3, 0.0, 2e-3))[0].axes == (0, 2, 4)


@pytest.mark.parametrize("axes", [(0, 1), (0, 1, 2, 3, 4)])
def test_axes_that_run_away_together_are_named_together_by_their_echoes(axes):
    robot = Robot()
    velocity = tuple([(2e-3 if n != ROLL else 0.1) * (n in axes) for n in range(5)])
    robot.watch.demand.sent([0] * 5)
    trip = robot.watch.demand.check(velocity)
    assert trip.reason is Reason.DRIVE_DISOBEYS and trip.axes == axes


def test_objections_of_one_tick_are_one_with_the_axes_of_all():
    one, other = Trip(Reason.POSITION_LEFT, "one", axes=(3,)), Trip(Reason.DRIVE_DISOBEYS, "other", axes=(0, 3))
    assert together([None, one, other]) == one._replace(axes=(0, 3))
    assert together([None, one]) is one and together([None, None]) is None
