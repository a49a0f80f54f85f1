"""What the driver itself watches: supervisor, own loop, encoders, following, rest; and how hard it stops for each."""

import itertools

import pytest
from sher3_common.reasons import ACTION, TEXT, Action, Reason
from sher3_description import ACTUATORS
from sher3_drivers.canopen.cia402 import Goal
from sher3_drivers.drive.report import driver_report
from sher3_drivers.errors import CommandRefused, DriverSettingsError
from sher3_drivers.settings import MotorDriverSettings, default_settings
from sher3_drivers.watches.trips import StopLog, Trip

SLOW = [0.001, -0.002, 0.003, 0.1, -0.004]
MS = 1_000_000


def ticks_to_stop(rig, limit=200):
    """Tick with commands until the driver stops by itself; return how many ticks that took."""
    for n in range(1, limit + 1):
        rig.tick(SLOW)
        if rig.driver.stop.first is not None:
            return n
    raise AssertionError("the driver did not stop")


def test_every_reason_has_a_sentence_and_an_action():
    assert set(TEXT) == set(ACTION) == set(Reason)
    assert len({*TEXT.values()}) == len(Reason)


def test_a_silent_supervisor_stops_the_robot_within_its_limit(rig):
    for _ in range(10):
        rig.tick(SLOW)
    rig.supervised = False
    assert ticks_to_stop(rig) <= rig.settings.supervisor_limit / rig.settings.period + 1
    assert rig.driver.stop.code is Reason.SUPERVISOR_SILENT
    rig.supervised = True
    for _ in range(20):
        rig.tick(SLOW)
    assert not rig.driver.enabled, "a supervisor that comes back enables nothing"
    with pytest.raises(CommandRefused):
        rig.driver.enable()


def test_without_a_supervisor_the_drives_are_never_enabled(make_rig):
    rig = make_rig()
    rig.supervised = False
    with pytest.raises(TimeoutError):
        rig.enable()
    assert rig.driver.stop.code is Reason.SUPERVISOR_SILENT


@pytest.mark.parametrize(
    ("hold", "reason"), [(18, Reason.MOVING), (20, Reason.CPU_STARVED), (30, Reason.DRIVE_HOST_LOST)]
)
def test_a_loop_that_was_held_up_stops_the_robot(rig, hold, reason):
    """The drives object by themselves to what is longer than the loop is allowed, and not to less."""
    rig.tick(SLOW)
    rig.now += hold * MS
    rig.stamp += hold * MS
    rig.tick(SLOW)
    assert rig.driver.stop.code is reason
    assert rig.driver.watches.loop.stall == (hold + 2) * MS


@pytest.mark.parametrize("jump", [-1000, -2, 25, 3_600_000])
def test_a_jump_of_the_clock_stops_the_robot(rig, jump):
    rig.tick(SLOW)
    rig.stamp += jump * MS
    rig.tick()
    assert rig.driver.stop.code is Reason.CLOCK


def test_after_a_held_up_tick_the_age_of_a_command_is_its_age_in_time(rig):
    """Lost ticks count: the drives would otherwise go on with an old command for `zero_age` further ticks."""
    rig.tick(SLOW)
    rig.now += 10 * MS
    rig.stamp += 10 * MS
    rig.tick()
    assert rig.driver.counters["held"] == 1


def slip(rig, name, field, by):
    rig.mock.drives[name].tamper = lambda f: f._replace(**{field: getattr(f, field) + by})


@pytest.mark.parametrize("name", ACTUATORS)
@pytest.mark.parametrize("field", ["load_position", "motor_position"])
@pytest.mark.parametrize(("limits", "ticks"), [(1.5, 5), (2.5, 3)])
def test_encoders_that_part_stop_the_robot_and_take_its_power(rig, name, field, limits, ticks):
    """10 ms; by twice their limit and more, 6 ms."""
    for _ in range(20):
        rig.tick(SLOW)
    slip(rig, name, field, limits * (rig.settings.encoder_angle if name == "roll" else rig.settings.encoder_distance))
    assert ticks <= ticks_to_stop(rig) <= ticks + 1
    stop = rig.driver.stop
    assert stop.code is Reason.ENCODERS_DISAGREE and stop.first.text.startswith(f"{name}: encoders")
    assert ("load side" if field == "load_position" else "motor encoder") in stop.first.text
    assert stop.first.value > stop.first.limit > 0.0 and stop.action is Action.POWER_OFF
    for _ in range(round(rig.settings.brake_time / rig.settings.period) + 5):
        rig.tick(SLOW)
    assert stop.first.axes == (ACTUATORS.index(name),)
    assert rig.states() == {"FAULT"}, "nobody can say that it brakes, so the host falls silent"
    assert rig.driver.goal is Goal.DISABLED
    with pytest.raises(CommandRefused):
        rig.driver.enable()


def test_lost_ticks_hide_no_slip(rig):
    """Every other tick lacks a TPDO, and the slip happens in one of them."""
    lose = itertools.cycle([True, False])
    for k in range(60):
        rig.mock.tamper_frames = (lambda c, frames, now: frames[16:] if c else frames) if next(lose) else None
        if k == 30:
            slip(rig, "delta_2", "load_position", 2e-5)
        rig.tick(SLOW)
    assert rig.driver.stop.code is Reason.ENCODERS_DISAGREE


def test_single_lost_ticks_at_speed_are_no_trip(rig):
    for k in range(200):
        rig.mock.tamper_frames = (lambda c, frames, now: frames[16:]) if k % 7 == 0 else None
        rig.tick([0.01, -0.01, 0.01, 0.8, 0.01])
    assert rig.driver.stop.first is None and rig.driver.counters["incomplete"] > 20


@pytest.mark.parametrize(("by", "steps"), [(4e-6, 1), (1e-4, 400)])
def test_small_or_slow_differences_are_no_trip(rig, by, steps):
    """Backlash of 4 um at once; a lead error or warmth of 0.1 mm over 0.8 s."""
    for k in range(steps + 50):
        slip(rig, "delta_1", "load_position", by * min(1.0, (k + 1) / steps) * (0.05 if steps > 1 else 1.0))
        rig.tick(SLOW)
    assert rig.driver.stop.first is None


@pytest.mark.parametrize("frozen", ["load_position", "motor_position"])
def test_a_frozen_encoder_is_named(rig, frozen):
    for _ in range(20):
        rig.tick(SLOW)
    value = {}
    rig.mock.drives["delta_3"].tamper = lambda f: f._replace(**{frozen: value.setdefault(0, getattr(f, frozen))})
    ticks = ticks_to_stop(rig)
    assert rig.driver.stop.code is Reason.ENCODER_FROZEN
    assert rig.driver.stop.first.text.startswith(f"delta_3: {frozen.split('_')[0]} encoder stands still")
    assert (ticks - 2) * 0.003 * rig.settings.period <= rig.settings.encoder_distance


def test_an_axis_that_does_not_follow_stops_the_robot(rig):
    """Both its encoders agree on half the way its drive says it makes."""
    for _ in range(20):
        rig.tick(SLOW)
    start = {}

    def half(f):
        first = start.setdefault(0, f)
        motor, load = (0.5 * (getattr(f, k) + getattr(first, k)) for k in ("motor_position", "load_position"))
        return f._replace(motor_position=motor, load_position=load)

    rig.mock.drives["tilt"].tamper = half
    ticks_to_stop(rig)
    stop = rig.driver.stop
    assert stop.code is Reason.POSITION_LEFT and stop.first.text.startswith("tilt")
    assert stop.first.limit <= rig.settings.position_distance + rig.settings.position_lag * 0.0041


def test_a_robot_that_moves_after_its_stop_loses_its_power(rig):
    rig.tick(SLOW)
    rig.driver.stop_for(Trip(Reason.COMMAND_STALE, "test"))
    assert rig.driver.stop.action is Action.QUICK_STOP
    for _ in range(round(rig.settings.brake_time / rig.settings.period) + 5):
        rig.tick()
    assert rig.driver.goal is Goal.STOPPED
    drift = itertools.count()
    rig.mock.drives["delta_2"].tamper = lambda f: f._replace(
        motor_position=f.motor_position + 1e-5 * next(drift), load_position=f.load_position
    )
    for _ in range(40):
        rig.tick()
    assert rig.driver.stop.code is Reason.COMMAND_STALE, "the first reason stays"
    assert rig.driver.stop.action is Action.POWER_OFF and rig.driver.goal is Goal.DISABLED
    assert rig.states() <= {"SWITCH_ON_DISABLED", "FAULT"}


@pytest.mark.parametrize(
    ("code", "reason", "action"),
    [
        (0x4310, Reason.DRIVE_OVER_TEMPERATURE, Action.POWER_OFF),
        (0x8130, Reason.DRIVE_HOST_LOST, Action.QUICK_STOP),
        (0x2310, Reason.DRIVE_EMERGENCY, Action.QUICK_STOP),
    ],
)
def test_emergencies_have_reasons_of_their_own(rig, code, reason, action):
    rig.tick(SLOW)
    rig.mock.drives["delta_1"].fault(code)
    rig.tick(SLOW)
    rig.tick(SLOW)
    assert rig.driver.stop.code is reason and rig.driver.stop.action is action


def test_the_most_severe_action_wins_and_the_first_reason_stays():
    log = StopLog()
    assert log.add(Trip(Reason.BUS_OFF, "first"), 5)
    assert not log.add(Trip(Reason.ENCODERS_DISAGREE, "second"), 6)
    assert not log.add(Trip(Reason.LINK_LOST, "third"), 7)
    assert (log.reason, log.code, log.since, log.later) == ("first", Reason.BUS_OFF, 5, 2)
    assert log.action is Action.POWER_OFF
    log.clear()
    assert log.reason is None and log.action is Action.NONE


def test_diagnostics_show_every_number_with_its_limit(rig):
    for _ in range(10):
        rig.tick(SLOW)
    _, _, values = driver_report(rig.driver)
    told = dict(values)
    for name in ACTUATORS:
        unit = "rad" if name == "roll" else "m"
        for reason in ("ENCODERS_DISAGREE", "FOLLOWING_ERROR"):
            value, limit = map(float, told[f"{reason} {name} [{unit}]"].split(" limit "))
            assert 0.0 <= value <= limit
    assert told["SUPERVISOR_SILENT heartbeat [s]"].endswith("limit 0.03")


@pytest.mark.parametrize("name", ["supervisor_limit", "stall_limit", "encoder_distance", "following_lag", "brake_time"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf"), 1e6])
def test_impossible_limits_are_refused(name, value):
    with pytest.raises(DriverSettingsError, match=name):
        MotorDriverSettings.checked(**{**default_settings().model_dump(), name: value})
