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
TICK = 2_000_000
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


@pytest.mark.parametrize(
    ("sensor", "hand", "limit"),
    [(0.3, 0.0, 0.45), (0.4, 0.0, 0.2), (0.6, 0.0, 0.07), (1.0, 0.0, 0.03), (-1.0, 1.0, 0.02), (6.0, 2.0, 0.02)],
)
def test_a_hand_that_only_one_feels_is_none(detector, sensor, hand, limit):
    """0.6 N passes 0.46 N behind 40 ms after 40 ms ln(1 / (1 - 0.46/0.6)) = 58 ms, and the share."""
    _, stamp = feel(detector, 1.0, 0.0, 0.0)
    objected, _ = feel(detector, 1.0, sensor, hand, stamp)
    assert objected is not None and objected - stamp <= limit * 1e9
    found = detector.check(objected)
    assert found.reason is Reason.HAND_DOUBTFUL and found.value > found.limit >= min(n for _, n in SETTINGS.hand_limits)


def test_a_small_false_force_is_believed(detector):
    """What is stated: up to 0.2 N nothing tells a false force from noise and friction."""
    _, stamp = feel(detector, 1.0, 0.0, 0.0)
    assert feel(detector, 5.0, 0.19, 0.0, stamp)[0] is None


def test_a_bias_that_drifts_is_taken_for_granted(detector):
    stamp = 0
    for step in range(100):
        objected, stamp = feel(detector, 0.2, 0.015 * step, 0.0, stamp)
        assert objected is None, "0.075 N/s against a memory of 2 s is 0.15 N"


def test_after_enabling_the_drives_take_over_a_hand_that_is_there_already(detector):
    """They take it within some kp/ki = 20 ms."""
    detector.begin()
    _, stamp = feel(detector, 0.08, 3.0, 0.0)
    assert feel(detector, 1.0, 3.0, 3.0, stamp)[0] is None
    detector.recover(0)
    assert detector.look(0).value == 0.0


def legs_hold(q, hand):
    """Return what the drives push with while a hand pushes with `hand` along z (N): J^T of both forces."""
    return KINEMATICS.jacobian(np.asarray(q))[:3, :3].T @ (WEIGHT - [0.0, 0.0, hand])


def sense(q, hand):
    """Return what the force sensor reads of a hand along z of {b} (N)."""
    rotation = KINEMATICS.transform_tip_to_base(np.asarray(q))[:3, :3]
    return (*(rotation.T @ [0.0, 0.0, hand]), 0.0, 0.0, 0.0)


def test_the_legs_hold_what_virtual_work_says(detector):
    """A push along z of 3 N is held by J^T F: the sum with the sensor stays what the platform weighs."""
    q = (1e-3, -2e-3, 3e-3, 0.2, 1e-3)
    smooth = 3.0 * np.sin(np.linspace(0.0, 20.0, 2000))
    for number, hand in enumerate(smooth):
        detector.feed(number * TICK, sense(q, hand), q, (*legs_hold(q, hand), 0.0, 0.0), STILL)
        assert detector.look(0).value < 0.15, "the sensor's low pass of 4 ms, at 15 N/s"


def test_a_hit_is_no_false_hand(detector):
    """The sensor feels at once a hand of 12 N that turns round; the drives hold it m/kp = 4 ms later."""
    q, held = (0.0,) * 5, 12.0
    for number in range(1000):
        hand = 12.0 if number // 200 % 2 == 0 else -12.0
        held += 0.4 * (hand - held)  # 2 ms of 4 ms: 1 - exp(-0.5)
        detector.feed(number * TICK, sense(q, hand), q, (*legs_hold(q, held), 0.0, 0.0), STILL)
        assert detector.check(0) is None


def drive_legs(detector, ticks, acceleration, force, strays=0.0):
    """Let the legs follow commands that begin after 400 ticks, m/s^2; they are also pushed by `force` (N) each.

    `strays`: speed by which the first leg leaves its command then, m/s. Returns whether the detector objected.
    """
    q, command, speed, objected = np.zeros(5), np.zeros(5), np.zeros(5), False
    for tick in range(ticks):
        begun = tick >= 400
        before = speed.copy()
        speed[:3] += 0.5 * (command - speed)[:3]
        q += speed * TICK * 1e-9
        q[0] += strays * TICK * 1e-9 * begun
        motion = 10.5 * (speed - before)[:3] / (TICK * 1e-9) + 60.0 * speed[:3]
        effort = legs_hold(q, 0.0) + motion + np.array([force, 0.0, 0.0]) * begun
        detector.feed(tick * TICK, (0.0,) * 6, tuple(q), (*effort, 0.0, 0.0), tuple(command))
        objected |= detector.check(tick * TICK) is not None
        command[:3] = min(5e-3, acceleration * TICK * 1e-9 * max(0, tick - 400))
    return objected


def test_what_the_legs_own_motion_takes_is_no_hand(detector):
    """19 N take a slider of 10.5 kg to 5 mm/s in 3 ms, and 0.3 N of friction stay; the sensor feels neither."""
    assert not drive_legs(detector, 800, acceleration=1.83, force=0.0)


@pytest.mark.parametrize(("strays", "objects"), [(0.0, True), (0.012, False)])
def test_a_leg_that_leaves_its_command_is_no_false_hand(strays, objects):
    """At rest 20 N more on a leg are a hand that nobody feels; of a leg that runs away they are its own force."""
    assert drive_legs(HandDetector(KINEMATICS, SETTINGS), 500, 0.0, 20.0, strays) is objects


def test_numbers_that_are_none_are_not_judged(detector):
    feel(detector, 1.0, 0.0, 0.0)
    detector.feed(10**10, (np.nan,) * 6, (0.0,) * 5, (0.0,) * 5, STILL)
    detector.feed(10**10 + TICK, (0.0,) * 6, (0.0,) * 5, (np.nan,) * 5, STILL)
    assert detector.check(0) is None
