"""The place of an axis against the sum of its commands, with numbers by hand."""

from __future__ import annotations

import math

import pytest
from sher3_common.reasons import ACTION, Action, Reason
from sher3_description import ACTUATORS, load_robot
from sher3_drivers.bus.frame import iter_frames, pack_frame
from sher3_drivers.canopen import objects as od
from sher3_drivers.canopen.cia402 import Controlword, Goal
from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.settings import default_settings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.motion import MotionWatch
from sher3_drivers.watches.position import PositionWatch
from sher3_drivers.watches.trips import StopLog

ROBOT = load_robot()
SCALES = [AxisScale.from_actuator(actuator) for actuator in ROBOT.actuators]
SETTINGS = default_settings(ROBOT.control_period)
PERIOD = SETTINGS.period
KI, KP = 132700.0, 2640.0
REST = (0.0,) * 5
LEG, ROLL = 0, 3
RESET_OF_ROLL = od.RPDO_BASE + 1 + ROLL


class Place:
    """The sum of one axis."""

    def __init__(self, axis, motor, load, effort):
        self._watch = PositionWatch(SCALES[axis : axis + 1], SETTINGS)
        self.advance(motor, load, effort, 0.0, 0.0)

    def advance(self, motor, load, effort, command, since=PERIOD):
        """Take readings and the command before them; the first ones are the beginning."""
        readings = DriveFeedback(0, (load,), (motor,), (0.0,), (effort,), (0.0,))
        self._watch.follow(readings, (command,), since)

    def __getattr__(self, name):
        axis = self._watch.axes[0]
        return axis[name] if name in ("left", "explained") else getattr(axis, name)


def travel_until_trip(axis, speed, effort=0.0, limit=2_000_000):
    """Let an axis that is told to rest creep at `speed`; return how far it is when it is found."""
    place = Place(axis, 0.0, 0.0, effort)
    count = SCALES[axis].motor_encoder
    for tick in range(1, limit):
        went = speed * PERIOD * tick
        reading = round(went / count) * count
        place.advance(reading, reading, effort, 0.0)
        if abs(place.departure) > place.limit:
            return abs(went)
    return math.inf


@pytest.mark.parametrize("speed", [1e-6, -1e-6, 1e-5, 1e-4, 1e-3, 12.2e-3])
def test_there_is_no_speed_at_which_a_leg_creeps_unseen(speed):
    """The limit is 7 um at rest; a reading rounds to a count of 1 um, and the tick that passes it adds its own way."""
    assert 6.5e-6 < travel_until_trip(LEG, speed) <= 7.5e-6 + 1.01 * abs(speed) * PERIOD + 1e-12


@pytest.mark.parametrize("speed", [1e-4, 1e-2, 1.2])
def test_nor_a_roll(speed):
    """0.4 mrad at rest are 12.7 counts: found with the 13th, which a reading shows from 12.5 to 13.5 of them on."""
    assert 12.5 * math.pi * 1e-5 - 1e-12 < travel_until_trip(ROLL, speed) <= 13.5 * math.pi * 1e-5 + speed * PERIOD


def test_an_axis_that_does_what_it_is_told_is_where_it_should_be():
    place = Place(LEG, 0.001, 0.001, 3.0)
    went = 0.001
    for tick in range(10_000):
        command = 0.005 * math.sin(0.01 * tick)
        went += command * PERIOD
        place.advance(went, went, 3.0, command)
    assert abs(place.left) < 1e-12 and abs(place.explained) < 1e-12


def test_what_a_hand_pushes_the_drive_off_is_explained_by_its_force():
    """13.27 N over ki are 100 um; the low pass of kp / ki = 19.9 ms has taken all of it but e^-50 after 1 s."""
    place = Place(LEG, 0.0, 0.0, 0.0)
    for _ in range(500):
        place.advance(-1e-4, -1e-4, 13.27, 0.0)
    assert place.left == pytest.approx(1e-4)
    assert place.explained == pytest.approx(1e-4, rel=1e-6)
    assert abs(place.departure) < 1e-9
    assert place.limit == pytest.approx(7e-6 + 0.1 * 1e-4)


def test_the_low_pass_is_that_of_the_drives_law():
    """A step of force F: after one period of 2 ms it has explained F / ki * 2 / 19.89 of the way."""
    place = Place(LEG, 0.0, 0.0, 0.0)
    place.advance(0.0, 0.0, 13.27, 0.0)
    assert place.explained == pytest.approx(1e-4 * PERIOD / (KP / KI))


def test_a_force_explains_no_more_than_the_bound():
    """150 N over ki would be 1.13 mm; the bound is 0.2 mm, so an axis 0.25 mm off is 50 um beyond what is believed."""
    place = Place(LEG, 0.0, 0.0, 0.0)
    for _ in range(500):
        place.advance(-2.5e-4, -2.5e-4, 150.0, 0.0)
    assert place.departure == pytest.approx(5e-5) and place.departure > place.limit


def test_the_limit_grows_with_the_commanded_speed_and_falls_back():
    """5 mm/s add 3 ms of it, 15 um; 0.5 s later e^-5 of that is left."""
    place = Place(LEG, 0.0, 0.0, 0.0)
    place.advance(0.005 * PERIOD, 0.005 * PERIOD, 0.0, 0.005)
    assert place.limit == pytest.approx(22e-6)
    for _ in range(250):
        place.advance(0.005 * PERIOD, 0.005 * PERIOD, 0.0, 0.0)
    assert place.limit == pytest.approx(7e-6 + 15e-6 * 0.98**250)


def feedback(tick, place, echo=REST, effort=REST):
    return DriveFeedback(round(tick * PERIOD * 1e9), place, place, REST, effort, echo)


def run(goal, places, stop=None):
    """Return the first trip of a robot whose motors and loads are at `places` and whose commands are zero."""
    checks, log = MotionWatch(SCALES, SETTINGS), stop or StopLog()
    checks.begin()
    for tick, place in enumerate(places):
        checks.demand.sent([0] * 5)
        now = round(tick * PERIOD * 1e9)
        if trip := checks.check(feedback(tick, place), goal, goal is Goal.ENABLED, log, now):
            return trip, tick
    return None, len(places)


def test_both_encoders_that_creep_alike_are_found_though_they_agree():
    """0.5 mm/s on three legs, the echo says zero: beyond 7 um / sqrt(3) after 10 ms, and all three are suspected."""
    trip, tick = run(Goal.ENABLED, [(5e-4 * PERIOD * k,) * 3 + (0.0, 0.0) for k in range(100)])
    assert trip.reason is Reason.POSITION_LEFT and trip.axes == (0, 1, 2)
    assert tick == 5 and trip.value == pytest.approx(5e-6)


@pytest.mark.parametrize("share, found", [(0.44, False), (0.46, True)])
def test_axes_are_judged_together_since_the_tip_adds_them_up(share, found):
    """Five axes off by a share s of their limits are at the limit together when 5 s^2 is 1: s = 0.447."""
    limits = [SETTINGS.position_angle if scale.revolute else SETTINGS.position_distance for scale in SCALES]
    trip, _ = run(Goal.ENABLED, [REST, tuple([share * limit for limit in limits])])
    assert (trip is not None) == found
    assert trip is None or trip.axes == (0, 1, 2, 3, 4)


def test_who_goes_slowly_beside_one_that_leaves_is_suspected_from_half_its_limit_on():
    """A leg at 20 um of 7; another one at 3 um, which is less than half of its limit, and the tilt at 4 um."""
    trip, _ = run(Goal.ENABLED, [REST, (20e-6, 3e-6, 0.0, 0.0, 4e-6)])
    assert trip.axes == (0, 4) and trip.value == pytest.approx(20e-6)


def test_a_disabled_robot_that_moves_is_found():
    """2 mm/s make 7 um in 1.8 ticks."""
    trip, tick = run(Goal.DISABLED, [(2e-3 * PERIOD * max(0, k - 100), 0.0, 0.0, 0.0, 0.0) for k in range(300)])
    assert trip.reason is Reason.MOVED_DISABLED and trip.axes == (0,)
    assert tick == 102


def test_one_on_its_way_to_be_enabled_is_watched_too():
    checks, log = MotionWatch(SCALES, SETTINGS), StopLog()
    checks.begin()
    checks.demand.sent([0] * 5)
    assert checks.check(feedback(0, REST), Goal.ENABLED, False, log, 0) is None
    assert (
        checks.check(feedback(1, (2e-5, *REST[1:])), Goal.ENABLED, False, log, 2_000_000).reason is Reason.POSITION_LEFT
    )


@pytest.mark.parametrize(("speed", "others"), [(0.0, "SWITCH_ON_DISABLED"), (1e-3, "QUICK_STOP_ACTIVE")])
def test_a_drive_that_leaves_its_place_loses_its_power_at_once_the_others_when_they_have_braked(
    make_rig, speed, others
):
    """Who has been told to rest for 6 ms has braked; a ramp of a tick and these 6 ms end 4 ticks after the stop."""
    rig = make_rig()
    rig.enable()
    rig.plant.step, honest = lambda command: honest([command[0] + 5e-4, *command[1:]]), rig.plant.step
    for _ in range(20):
        rig.tick((speed,) * 3 + (0.0, 0.0))
        if rig.driver.stop.first is not None:
            break
    assert rig.driver.stop.code in (Reason.POSITION_LEFT, Reason.DRIVE_DISOBEYS)
    seen = []
    for _ in range(6):
        rig.tick()
        seen.append([drive.state.name for drive in rig.driver.session.drives])
    assert seen[1] == ["SWITCH_ON_DISABLED", *[others] * (len(ACTUATORS) - 1)]
    assert seen[-1] == ["SWITCH_ON_DISABLED"] * len(ACTUATORS)


def words_and_beats(rig):
    """Return lists that grow with the controlwords that delta_1 is sent, and with the host's heartbeats."""
    words, beats = [], []

    def listen(channel, frames, now):
        for can_id, data in iter_frames(frames):
            if can_id == od.RPDO_BASE + 1:
                words.append(int.from_bytes(data[:2], "little"))
            elif can_id == od.HEARTBEAT_BASE + rig.settings.host_id:
                beats.append(now)
        return frames

    rig.mock.tamper_received = listen
    return words, beats


def turn_until_found(rig):
    """Let the motor of delta_1 turn at 2 mm/s, whatever its drive does, until the driver says so."""
    rig.mock.drives["delta_1"].turned = lambda velocity: 2e-3
    for tick in range(20):
        rig.tick()
        if rig.driver.stop.first is not None:
            return tick
    raise AssertionError("nobody noticed")


def test_a_disabled_robot_that_moves_has_its_power_cut_and_says_so(make_rig):
    """7 um at 2 mm/s are 1.8 ticks, after the 0.1 s of a rest; then no heartbeat, and *disable voltage* alone."""
    rig = make_rig()
    rig.enable()
    rig.driver.disable()
    for _ in range(60):
        rig.tick()
    assert turn_until_found(rig) <= 4
    words, beats = words_and_beats(rig)
    for _ in range(20):
        rig.tick()
    stop = rig.driver.stop
    assert stop.code is Reason.MOVED_DISABLED and ACTION[stop.code] is Action.POWER_OFF
    assert "delta_1" in stop.first.text and not beats
    assert set(words) <= {Controlword.DISABLE_VOLTAGE.value}


def test_a_robot_that_moves_while_its_fault_is_being_reset_is_found(make_rig):
    rig = make_rig()
    rig.enable()
    rig.mock.drives["roll"].fault(0x2310)
    for _ in range(60):
        rig.tick()

    def lose_resets(channel, frames, now):
        kept = [(number, data) for number, data in iter_frames(frames) if number != RESET_OF_ROLL or data[0] != 0x80]
        return b"".join(pack_frame(number, data) for number, data in kept)

    rig.mock.tamper_received = lose_resets
    rig.driver.reset()
    for _ in range(60):
        rig.tick()
    assert rig.driver.stop.first is None and "FAULT" in rig.states()
    assert turn_until_found(rig) <= 4
    assert rig.driver.stop.code is Reason.MOVED_DISABLED


def test_an_axis_that_was_pushed_before_it_is_enabled_again_is_not_accused(make_rig):
    """It is found as it moves; what the encoders said before a recovery is of the past."""
    rig = make_rig()
    rig.enable()
    rig.tick(REST)
    rig.driver.disable()
    for _ in range(5):
        rig.tick()
    rig.plant.position = [3e-3] * len(ACTUATORS)
    rig.tick()
    assert rig.driver.stop.code is Reason.MOVED_DISABLED
    for _ in range(60):
        rig.tick()
    rig.driver.reset()
    for _ in range(60):
        rig.tick()
    rig.enable()
    for _ in range(50):
        rig.tick(REST)
    assert rig.driver.stop.first is None
