"""A hand is felt by the force sensor and by the drives: what only one of them feels is no hand."""

from __future__ import annotations

import numpy as np
import pytest
from sher3_common.reasons import Reason
from sher3_control.settings import SupervisorSettings
from sher3_control.supervision.hand import HandDetector
from sher3_description import load_robot
from sher3_kinematics import RobotKinematics

KINEMATICS = RobotKinematics(load_robot())
SETTINGS = SupervisorSettings()
TICK = 10_000_000
STILL = (0.0,) * 5
WEIGHT = np.array([0.0, 0.0, 9.8])


@pytest.fixture
def detector():
    return HandDetector(KINEMATICS, SETTINGS)


def feel(detector, seconds, sensor, hand, start=0):
    """Let the sensor read `sensor` and the legs hold `hand` (z, N) for so long; return when it objects, and the end."""
    stamp = start
    for stamp in range(start, start + round(seconds * 1e9), TICK):
        detector.follow(stamp, np.array([0.0, 0.0, sensor]), WEIGHT - [0.0, 0.0, hand])
        if detector.check(stamp) is not None:
            return stamp, stamp + TICK
    return None, stamp + TICK


@pytest.mark.parametrize("force", [0.1, 1.0, 6.0])
def test_a_hand_that_both_feel_comes_goes_and_turns_round(detector, force):
    stamp = 0
    for hand in (0.0, force, -force, 0.0, force):
        objected, stamp = feel(detector, 1.0, hand, hand, stamp)
        assert objected is None


@pytest.mark.parametrize(("sensor", "hand"), [(1.0, 0.0), (-1.0, 1.0), (6.0, 0.0), (6.0, 2.0)])
def test_a_hand_that_only_one_feels_is_none(detector, sensor, hand):
    """Low pass of 50 ms: 1 N passes the limit of 0.8 N after 50 ms ln(1 / 0.2) = 80 ms."""
    _, stamp = feel(detector, 1.0, 0.0, 0.0)
    objected, _ = feel(detector, 1.0, sensor, hand, stamp)
    assert objected is not None and objected - stamp <= 0.15 * 1e9
    found = detector.check(objected)
    assert found.reason is Reason.HAND_DOUBTFUL and found.value > found.limit >= SETTINGS.hand_force


def test_a_small_false_force_is_believed(detector):
    """What is stated: up to 0.8 N nothing tells a false force from friction and inertia."""
    _, stamp = feel(detector, 1.0, 0.0, 0.0)
    assert feel(detector, 5.0, 0.75, 0.0, stamp)[0] is None


def test_a_bias_that_drifts_is_taken_for_granted(detector):
    stamp = 0
    for step in range(100):
        objected, stamp = feel(detector, 0.2, 0.05 * step, 0.0, stamp)
        assert objected is None, "0.25 N/s against a memory of 2 s is 0.5 N"


def test_after_enabling_the_drives_take_over_a_hand_that_is_there_already(detector):
    detector.begin()
    _, stamp = feel(detector, 0.15, 3.0, 0.0)
    assert feel(detector, 1.0, 3.0, 3.0, stamp)[0] is None
    detector.recover(0)
    assert detector.look(0).value == 0.0


def test_the_legs_hold_what_virtual_work_says(detector):
    """A push along z of 3 N is held by J^T F: the sum with the sensor stays what the platform weighs."""
    q = (1e-3, -2e-3, 3e-3, 0.2, 1e-3)
    jacobian = KINEMATICS.jacobian(np.array(q))[:3, :3]
    for number, hand in enumerate((0.0, 3.0, -3.0) * 40):
        effort = jacobian.T @ (WEIGHT - [0.0, 0.0, hand])
        rotation = KINEMATICS.transform_tip_to_base(np.array(q))[:3, :3]
        wrench = (*(rotation.T @ [0.0, 0.0, hand]), 0.0, 0.0, 0.0)
        detector.feed(number * TICK, wrench, q, (*effort, 0.0, 0.0), STILL)
        assert detector.look(0).value < 1e-9


def test_a_hit_that_the_drives_feel_late_is_no_false_hand(detector):
    """A hand of 6 N that turns round at once reaches the drives 10 ms later."""
    q, jacobian = (0.0,) * 5, KINEMATICS.jacobian(np.zeros(5))[:3, :3]
    sensor = held = 6.0
    for number in range(200):
        effort = (*(jacobian.T @ (WEIGHT - [0.0, 0.0, held])), 0.0, 0.0)
        detector.feed(number * TICK, (0.0, 0.0, sensor, 0.0, 0.0, 0.0), q, effort, STILL)
        assert detector.check(0) is None, number
        held, sensor = sensor, 6.0 if number // 40 % 2 == 0 else -6.0


def test_inertia_is_no_hand(detector):
    """A slider of 10.5 kg needs 5 N to gain 5 mm/s in 10 ms; the sensor feels nothing of it."""
    q, jacobian = (0.0,) * 5, KINEMATICS.jacobian(np.zeros(5))[:3, :3]
    weight, speed = jacobian.T @ WEIGHT, 0.0
    for number in range(200):
        faster = 5e-3 * (number % 40 == 0) - 5e-3 * (number % 40 == 20)
        speed += faster
        effort = (*(weight + 10.5 * faster / 0.01), 0.0, 0.0)
        detector.feed(number * TICK, (0.0,) * 6, q, effort, (speed,) * 3 + (0.0, 0.0))
        assert detector.check(0) is None


@pytest.mark.parametrize(("speed", "objects"), [(0.0, True), (0.012, False)])
def test_a_leg_that_leaves_its_command_is_no_false_hand(detector, speed, objects):
    """At rest 20 N more on a leg are a hand that nobody feels; of a leg that runs away they are its own force."""
    q, effort, objected = np.zeros(5), np.full(5, 3.0), False
    for tick in range(60):
        away = tick >= 40
        q[0] += speed * TICK * 1e-9 * away
        effort[0] = 23.0 if away else 3.0
        detector.feed(tick * TICK, (0.0,) * 6, tuple(q), tuple(effort), STILL)
        objected |= detector.check(tick * TICK) is not None
    assert objected is objects


def test_the_inertia_of_a_leg_that_does_as_commanded_is_no_hand(detector):
    """20 N for 50 ms take a leg from rest to 5 mm/s, by 1 mm/s a look; the sensor feels nothing."""
    q, effort, command = np.zeros(5), np.full(5, 3.0), np.zeros(5)
    for tick in range(80):
        hastes = 40 <= tick < 45
        command[0] += 1e-3 * hastes
        q += command * TICK * 1e-9
        effort[0] = 23.0 if hastes else 3.0
        detector.feed(tick * TICK, (0.0,) * 6, tuple(q), tuple(effort), tuple(command))
        assert detector.check(tick * TICK) is None
