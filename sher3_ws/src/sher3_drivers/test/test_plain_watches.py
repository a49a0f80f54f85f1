"""The compiled watches, and the short ways through the others, say what the plain ones say, to the last bit."""

from __future__ import annotations

import random
from collections import Counter

import pytest
from plain_watches import PlainAxis, PlainPlace
from sher3_common.reasons import Reason
from sher3_description import load_robot
from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.settings import default_settings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.demand import DemandCheck
from sher3_drivers.watches.fingerprint import FingerprintCheck
from sher3_drivers.watches.frozen import FrozenCheck
from sher3_drivers.watches.joints import JointWatch
from sher3_drivers.watches.position import PositionWatch

ROBOT = load_robot()
SCALES = [AxisScale.from_actuator(actuator) for actuator in ROBOT.actuators]
TICKS, AXES = 400, range(5)
HEALTHY = ("moves", "moves", "rests")
FAULTS = ("load stands", "motor stands", "drifts", "jumps", "astray", "late", "disobeys")


def history(seed, period):
    """Yield (feedback, commands held before it, time since the last one) of a robot whose faults come and go."""
    dice = random.Random(seed)
    command, motor, load, effort = [0.0] * 5, [0.0] * 5, [0.0] * 5, [0.0] * 5
    past, kinds = [(0.0,) * 5], ["moves"] * 5
    for tick in range(TICKS):
        if dice.random() < 0.03:
            kinds[dice.randrange(5)] = dice.choice(HEALTHY + (FAULTS if dice.random() < 0.5 else HEALTHY))
        since = period * (1 if dice.random() < 0.97 else dice.randint(2, 30)) if tick else 0.0
        echo = [0.0] * 5
        for axis, (scale, kind) in enumerate(zip(SCALES, kinds, strict=True)):
            echo[axis] = past[-min(3, len(past))][axis] if kind == "late" else command[axis]
            echo[axis] = 0.3 * scale.velocity_limit if kind == "disobeys" else echo[axis]
            way = (echo[axis] + (0.5 * scale.velocity_limit if kind == "astray" else 0.0)) * since
            drift = 3e-4 * since if kind == "drifts" else 2e-4 * (dice.random() < 0.1) if kind == "jumps" else 0.0
            motor[axis] += 0.0 if kind == "motor stands" else way
            load[axis] += 0.0 if kind == "load stands" else way + drift
            effort[axis] = effort[axis] if kind in ("late", "rests") else dice.gauss(0.0, 3.0)
            motor[axis] = round(motor[axis] / scale.motor_encoder) * scale.motor_encoder
            load[axis] = round(load[axis] / scale.load_encoder) * scale.load_encoder
        held = tuple(command)
        yield DriveFeedback(tick, tuple(load), tuple(motor), held, tuple(effort), tuple(echo)), held, since
        past.append(held)
        for axis, (scale, kind) in enumerate(zip(SCALES, kinds, strict=True)):
            speed = 0.0 if kind == "rests" else 0.1 * scale.velocity_limit * dice.uniform(-1.0, 1.0)
            command[axis] = round(speed / scale.velocity) * scale.velocity


@pytest.fixture(params=[1e-3, 2e-3], ids=["1 kHz", "500 Hz"], scope="module")
def settings(request):
    return default_settings(request.param)


def test_the_compiled_check_of_the_encoders_is_the_plain_one(settings):
    said = Counter()
    for seed in range(40):
        watch, plain = JointWatch(SCALES, settings), [PlainAxis(scale, settings) for scale in SCALES]
        for feedback, _, since in history(seed, settings.period):
            expected, hole = [None] * 5, max(settings.missing_limit * settings.period, settings.stall_limit)
            readings = zip(feedback.motor_position, feedback.load_position, feedback.velocity_demand, strict=True)
            for number, (axis, (motor, load, demand)) in enumerate(zip(plain, readings, strict=True)):
                if 0.0 < since <= hole:
                    expected[number] = axis.check(motor, load, demand * since, demand)
                else:
                    axis.begin(motor, load)
            objects = zip(plain, expected, strict=True)
            off = [n for n, (a, trip) in enumerate(objects) if trip or a.stray_ticks >= a.limits.astray_ticks]
            first = next(filter(None, expected), None)
            assert watch.check(feedback, since) == (first and first._replace(axes=tuple(off)))
            said[first and first.reason] += 1
            for axis, compiled in zip(plain, watch.axes, strict=True):
                remembered = axis.gap, axis.error, axis.load_error, axis.drift_limit, axis.error_limit, axis.stray_ticks
                names = ("gap", "error", "load_error", "drift_limit", "error_limit", "stray_ticks")
                assert tuple(compiled[name] for name in names) == remembered
    assert set(said) == {None, Reason.ENCODER_FROZEN, Reason.ENCODERS_DISAGREE, Reason.FOLLOWING_ERROR}


def test_the_compiled_sum_of_the_commands_is_the_plain_one(settings):
    tripped = 0
    for seed in range(40):
        watch, plain = PositionWatch(SCALES, settings), [PlainPlace(scale, settings) for scale in SCALES]
        for tick, (feedback, held, since) in enumerate(history(seed, settings.period)):
            readings = zip(feedback.motor_position, feedback.load_position, feedback.effort, strict=True)
            if begins := tick % 150 == 0:
                watch.begin()
            for place, said, command in zip(plain, readings, held, strict=True):
                place.begin(*said) if begins else place.advance(*said, command, since)
            watch.follow(feedback, held, since)
            trip, shares = watch.judge(), [place.share for place in plain]
            assert (trip is None) == (sum(share**2 for share in shares) <= 1.0)
            tripped += trip is not None
            if trip is not None:
                worst = max(AXES, key=shares.__getitem__)
                suspects = [n for n in AXES if shares[n] > 0.5 * min(1.0, shares[worst])]
                value = abs(plain[worst].left - plain[worst].explained)
                assert (trip.value, trip.limit, trip.axes) == (value, plain[worst].limit, tuple(suspects))
            assert watch.moved == tuple(place.moved for place in plain)
            assert [axis.limit for axis in watch.axes] == [place.limit for place in plain]
    assert tripped > 100


@pytest.mark.parametrize("kind", [DemandCheck, FingerprintCheck])
def test_the_short_way_of_an_echo_that_repeats_its_command_is_the_long_one(settings, kind):
    """A list is equal to no tuple, so it goes the long way."""
    found = 0
    for seed in range(30):
        short, long = kind(SCALES, settings), kind(SCALES, settings)
        for feedback, held, _ in history(seed, settings.period):
            for check in (short, long):
                if isinstance(check, DemandCheck):
                    check.sent([round(v / scale.velocity) for v, scale in zip(held, SCALES, strict=True)])
                else:
                    check.sync(held)
            trip = short.check(feedback.velocity_demand)
            assert trip == long.check(list(feedback.velocity_demand))
            assert vars(short) == vars(long)
            found += trip is not None
    assert found


def test_the_short_way_of_reports_that_all_change_is_the_long_one(settings):
    found = 0
    for seed in range(30):
        check, travel, last, limits = FrozenCheck(SCALES, settings), [0.0] * 5, None, None
        limits = [settings.encoder_angle if s.revolute else settings.encoder_distance for s in SCALES]
        for feedback, held, since in history(seed, settings.period):
            said = list(zip(feedback.motor_position, feedback.load_position, feedback.effort, strict=True))
            expected = None
            for axis in AXES if last else ():
                travel[axis] = travel[axis] + abs(held[axis]) * since if said[axis] == last[axis] else 0.0
                if travel[axis] > limits[axis]:
                    expected = travel[axis]
                    break
            last = said
            trip = check.check(feedback, held, since)
            assert (trip and trip.value, check.travel) == (expected, travel)
            found += trip is not None
    assert found
