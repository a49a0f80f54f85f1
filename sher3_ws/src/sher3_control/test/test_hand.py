"""A hand is felt by the force sensor and by the drives: what only one of them feels is no hand."""

from __future__ import annotations

import numpy as np
import pytest
from sher3_common.reasons import Action, Reason
from sher3_control.settings import ControlSettings
from sher3_control.supervision.hand import HandDetector
from sher3_description import load_robot
from sher3_kinematics import RobotKinematics

ROBOT = load_robot()
KINEMATICS = RobotKinematics(ROBOT)
CONTROL = ControlSettings.from_robot(ROBOT)
SETTINGS = CONTROL.supervisor
TICK = 2_000_000
STILL = (0.0,) * 5
UP = np.array([0.0, 0.0, 1.0, 0.0, 0.0])
ABOUT_ROLL = np.array([0.0, 0.0, 0.0, 1.0, 0.0])


@pytest.fixture
def detector():
    return HandDetector(KINEMATICS, CONTROL)


def feel(detector, seconds, sensor, hand, start=0, along=UP, speed=0.0):
    """Let the sensor feel `sensor` and the drives hold `hand` (N) for so long; return when it objects, and the end.

    `speed`: of the tip, along x [m/s].
    """
    stamp, moved = start, np.array([speed * TICK * 1e-9, 0.0, 0.0, 0.0, 0.0, 0.0])
    for stamp in range(start, start + round(seconds * 1e9), TICK):
        detector.follow(stamp, sensor * along, -hand * along, moved)
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
@pytest.mark.parametrize(("along", "arm"), [(UP, 1.0), (ABOUT_ROLL, 0.015)])
def test_a_hand_that_only_one_feels_is_none(detector, sensor, hand, limit, along, arm):
    """0.6 N passes 0.46 N behind 40 ms after 40 ms ln(1 / (1 - 0.46/0.6)) = 58 ms, and the share; torques alike."""
    _, stamp = feel(detector, 1.0, 0.0, 0.0)
    objected, _ = feel(detector, 1.0, sensor, hand, stamp, along)
    assert objected is not None and objected - stamp <= limit * 1e9
    found = detector.check(objected)
    assert found.reason is Reason.HAND_DOUBTFUL and found.unit == ("N" if arm == 1.0 else "N m")
    assert found.value > found.limit >= arm * min(n for _, n in SETTINGS.hand_limits)


def test_a_small_false_force_is_no_doubt_while_it_moves_nothing(detector):
    """What is stated: up to 0.2 N nothing tells a false force from noise, friction and an unknown weight."""
    _, stamp = feel(detector, 1.0, 0.0, 0.0)
    assert feel(detector, 5.0, 0.19, 0.0, stamp)[0] is None


@pytest.mark.parametrize("along", [UP, ABOUT_ROLL])
def test_a_force_that_moves_the_tip_while_the_drives_feel_nobody_is_bounded(detector, along):
    """60 um at 50 um/s are over after 1.2 s, of a force too small for all else; a hand of that size may go on."""
    _, stamp = feel(detector, 1.0, 0.0, 0.0)
    objected, _ = feel(detector, 3.0, 0.075, 0.0, stamp, along, speed=50e-6)
    assert (objected - stamp) * 1e-9 == pytest.approx(1.2, abs=0.01)
    found = detector.check(objected)
    assert (found.reason, found.unit, found.limit) == (Reason.HAND_DOUBTFUL, "um", pytest.approx(60.0))
    assert found.value == pytest.approx(60.0, abs=0.2)
    detector.begin()
    _, stamp = feel(detector, 1.0, 0.0, 0.0, objected + TICK)
    assert feel(detector, 10.0, 0.15, 0.15, stamp, along, speed=50e-6)[0] is None


def test_a_firm_hand_is_forgotten_as_soon_as_a_light_one(detector):
    """0.105 N are 0.07 N after 0.25 s ln 1.5 = 101 ms; then 60 um at 50 um/s take 1.2 s."""
    _, stamp = feel(detector, 1.0, 0.0, 0.0)
    _, stamp = feel(detector, 2.0, 3.0, 3.0, stamp)
    objected, _ = feel(detector, 3.0, 0.15, 0.0, stamp, speed=50e-6)
    assert (objected - stamp) * 1e-9 == pytest.approx(1.2 + 0.101, abs=0.01)


def test_a_hand_that_is_felt_ends_the_travel_without_one(detector):
    _, stamp = feel(detector, 1.0, 0.0, 0.0)
    for _ in range(5):
        objected, stamp = feel(detector, 0.9, 0.075, 0.0, stamp, speed=50e-6)
        assert objected is None, "45 um"
        objected, stamp = feel(detector, 0.5, 0.3, 0.3, stamp, speed=50e-6)
        assert objected is None


def test_a_travel_that_a_hand_ends_before_the_supervisor_looks_is_told_with_its_value(detector):
    """60 um at 50 um/s are over after 1.2 s; a hand comes at 1.25 s, and the next look is behind it."""
    _, stamp = feel(detector, 1.0, 0.0, 0.0)
    moved = np.array([50e-6 * TICK * 1e-9, 0.0, 0.0, 0.0, 0.0, 0.0])
    for tick in range(1000):
        hand = 0.15 * (tick >= 625)
        detector.follow(stamp + tick * TICK, 0.15 * UP, -hand * UP, moved)
    found = detector.check(stamp)
    assert (found.unit, found.limit) == ("um", pytest.approx(60.0)) and 62.0 < found.value < 80.0
    assert "force sensor 0 " not in str(found) and detector.check(stamp) is None


def test_along_one_way_a_gain_that_grows_is_found_early(detector):
    """0.6 N that become 0.72: behind 0.8 s their change passes 0.08 N after 0.8 s ln 3 = 0.88 s; standing, never."""
    _, stamp = feel(detector, 2.0, 0.6, 0.6, speed=50e-6)
    objected, _ = feel(detector, 2.0, 0.72, 0.6, stamp, speed=50e-6)
    assert (objected - stamp) * 1e-9 == pytest.approx(0.88, abs=0.01)
    found = detector.check(objected)
    assert (found.reason, found.unit, found.limit) == (Reason.HAND_DOUBTFUL, "N", pytest.approx(0.08))
    detector.begin()
    _, stamp = feel(detector, 2.0, 0.6, 0.6, objected + TICK)
    assert feel(detector, 5.0, 0.72, 0.6, stamp)[0] is None


def test_a_bias_that_drifts_is_taken_for_granted_up_to_its_level(detector):
    """0.01 N/s behind a memory of 2 s: 0.2 N are passed after 22 s."""
    stamp, objected = 0, None
    for step in range(300):
        objected, stamp = feel(detector, 0.1, 0.001 * step, 0.0, stamp)
        if objected is not None:
            break
    assert objected * 1e-9 == pytest.approx(22.0, abs=0.2)


def test_a_weight_that_the_robot_file_does_not_know_is_found_after_settling(detector):
    """A tare under 0.3 N that stays there: the sensor says nothing, and the drives hold it."""
    objected, _ = feel(detector, 1.0, 0.0, 0.3)
    assert objected * 1e-9 == pytest.approx(SETTINGS.hand_settling, abs=0.003)


def test_legs_under_each_other_s_names_are_told_while_it_settles(detector):
    """0.6 N along x, which the drives hold at 120 degrees to it: 1.04 N, taken as 1 N of which 0.66 count at 40 ms."""
    sensor, hand = np.array([0.6, 0.0, 0.0, 0.0, 0.0]), np.array([-0.3, 0.52, 0.0, 0.0, 0.0])
    for stamp in range(0, 10**9, TICK):
        detector.follow(stamp, sensor, -hand)
        if detector.check(stamp) is not None:
            break
    assert 0.09 < stamp * 1e-9 < 0.16
    detector.recover(stamp)
    assert (detector.look(stamp).value, detector.look(stamp).unit) == (0.0, "N")


def test_after_enabling_the_drives_take_over_a_hand_that_is_there_already(detector):
    """They take it within some kp/ki = 20 ms."""
    detector.begin()
    _, stamp = feel(detector, 0.08, 3.0, 0.0)
    assert feel(detector, 1.0, 3.0, 3.0, stamp)[0] is None
    detector.recover(0)
    assert detector.look(0).value == 0.0


def test_grips_just_after_enabling_are_not_taken_for_the_level(detector):
    """Four of 6 N that the drives hold 4 ms later are 0.5 N in the mean of 0.18 s; 1 N counts, which is 0.09 N."""
    _, stamp = feel(detector, 0.19, 0.0, 0.0)
    for sensor, hand, seconds in 4 * ((6.0, 0.0, 0.004), (6.0, 6.0, 0.02), (0.0, 0.0, 0.02)):
        objected, stamp = feel(detector, seconds, sensor, hand, stamp)
        assert objected is None
    assert feel(detector, 1.0, 6.0, 6.0, stamp)[0] is None


@pytest.mark.parametrize("held", [0.05, 0.2, 0.24, 0.5])
def test_a_firm_hand_that_leaves_while_the_mean_is_not_known_is_missed_as_soon_as_later(detector, held):
    """6 N: 0.65 N, the 0.2 N of a level and 12 % of the hand behind 20 ms are there after 6 ms."""
    _, stamp = feel(detector, 0.12, 0.0, 0.0)
    _, stamp = feel(detector, held, 6.0, 6.0, stamp)
    objected, _ = feel(detector, 0.5, 6.0, 0.0, stamp)
    assert (objected - stamp) * 1e-9 <= 0.008


def drives_hold(q, wrench):
    """Return what the drives push with while a hand pushes with `wrench` (6,) in {b}: weight, less J^T of it."""
    return KINEMATICS.gravity_load(q) - KINEMATICS.jacobian(np.asarray(q)).T @ wrench


def sense(q, wrench):
    """Return the contact wrench in {t} of one in {b}."""
    rotation = KINEMATICS.transform_tip_to_base(np.asarray(q))[:3, :3]
    return (*(rotation.T @ wrench[:3]), *(rotation.T @ wrench[3:]))


def hand_of(force, torque=0.0):
    """Return a hand that pushes along z of {b} and turns about x (6,)."""
    return np.array([0.0, 0.0, force, torque, 0.0, 0.0])


def test_the_drives_hold_what_virtual_work_says(detector):
    """A push along z of 3 N and a turn of 20 mN m are held by J^T of them: the sum with the sensor stays zero."""
    q = (1e-3, -2e-3, 3e-3, 0.2, 1e-3)
    smooth = np.sin(np.linspace(0.0, 20.0, 2000))
    for number, part in enumerate(smooth):
        wrench = hand_of(3.0 * part, 0.02 * part)
        detector.feed(number * TICK, sense(q, wrench), q, drives_hold(q, wrench), STILL)
        found = detector.look(number * TICK)
        assert found.value < 0.3 * found.limit, "the sensor's low pass of 4 ms, at 15 N/s"


@pytest.mark.parametrize("turned", [hand_of(0.0, 0.02), np.array([0.0, 0.0, 0.0, 0.0, 0.02, 0.0])])
def test_a_torque_that_the_drives_do_not_hold_is_false(detector, turned):
    """Roll turns about x of {b}, and tilt about y where roll is zero."""
    for number in range(600):
        wrench = turned * (number >= 400)
        detector.feed(number * TICK, sense(STILL, wrench), STILL, drives_hold(STILL, 0.0 * wrench), STILL)
        if detector.check(0) is not None:
            break
    found = detector.check(0)
    assert found.unit == "N m" and number - 400 <= 20, "20 mN m: 1.3 N at 15 mm, within 40 ms"


def test_a_hit_is_no_false_hand(detector):
    """The sensor feels at once a hand of 12 N that turns round; the drives hold it m/kp = 4 ms later."""
    q, held = (0.0,) * 5, 12.0
    for number in range(1000):
        hand = 12.0 if number // 200 % 2 == 0 else -12.0
        held += 0.4 * (hand - held)  # 2 ms of 4 ms: 1 - exp(-0.5)
        detector.feed(number * TICK, sense(q, hand_of(hand)), q, drives_hold(q, hand_of(held)), STILL)
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
        effort = drives_hold(tuple(q), hand_of(0.0))
        effort[:3] += 10.5 * (speed - before)[:3] / (TICK * 1e-9) + 60.0 * speed[:3]
        effort[0] += force * begun
        detector.feed(tick * TICK, (0.0,) * 6, tuple(q), effort, tuple(command))
        objected |= detector.check(tick * TICK) is not None
        command[:3] = min(5e-3, acceleration * TICK * 1e-9 * max(0, tick - 400))
    return objected


def test_what_the_legs_own_motion_takes_is_no_hand(detector):
    """19 N take a slider of 10.5 kg to 5 mm/s in 3 ms, and 0.3 N of friction stay; the sensor feels neither."""
    assert not drive_legs(detector, 800, acceleration=1.83, force=0.0)


@pytest.mark.parametrize(("strays", "force", "objects"), [(0.0, 20.0, True), (0.012, 20.0, True), (0.012, 1.0, False)])
def test_a_leg_that_leaves_its_command_is_judged_coarsely(strays, force, objects):
    """At rest 1 N more on a leg is a hand that nobody feels; of a leg that runs away it may be its own force."""
    assert drive_legs(HandDetector(KINEMATICS, CONTROL), 500, 0.0, force, strays) is objects


@pytest.mark.parametrize("along", [UP, ABOUT_ROLL])
def test_a_drive_that_holds_what_nobody_feels_loses_its_power(detector, along):
    """A force or a torque; a sensor that feels what no drive holds is no reason for that."""
    _, stamp = feel(detector, 1.0, 0.0, 0.0)
    assert feel(detector, 0.1, 0.0, 2.0, stamp, along)[0] is not None
    assert detector.check(0).action is Action.POWER_OFF
    detector.begin()
    _, stamp = feel(detector, 1.0, 0.0, 0.0, stamp + 10**9)
    assert feel(detector, 0.1, 2.0, 0.0, stamp)[0] is not None
    assert detector.check(0).action is Action.QUICK_STOP


def test_while_a_leg_strays_the_law_does_not_go_far(detector):
    """An encoder that jitters keeps the sums from being judged: 0.12 s of motion are all that it may take."""
    q, command = np.zeros(5), np.array([5e-4, 5e-4, 5e-4, 0.0, 0.0])
    wrench, objected = hand_of(1.0), None
    for tick in range(2000):
        q[:3] += 5e-4 * TICK * 1e-9
        shown = q + np.array([1e-5 * (tick // 4 % 2), 0.0, 0.0, 0.0, 0.0]) * (tick > 396)
        effort = drives_hold(tuple(shown), wrench * (tick <= 400))
        effort[:3] += 60.0 * 5e-4
        detector.feed(tick * TICK, sense(shown, wrench), tuple(shown), effort, tuple(command))
        if detector.check(0) is not None:
            objected = tick
            break
    assert objected is not None and 0.12 <= (objected - 396) * TICK * 1e-9 <= 0.14
    assert detector.look(0).unit == "s"


@pytest.mark.parametrize(("felt", "objects"), [(5.0, False), (0.0, True)])
def test_a_firm_hand_that_makes_legs_stray_moves_the_tip_by_itself(detector, felt, objects):
    """5 N that arrive at once make legs stray while the law takes the tip 5 mm/s * 40 ms = 200 um along."""
    q, speed, objected = np.zeros(5), np.zeros(5), False
    for tick in range(430):
        pushed, before = tick >= 400, speed.copy()
        command = np.array([5e-3, 5e-3, 5e-3, 0.0, 0.0]) * pushed
        speed[:3] += 0.5 * (command - speed)[:3] * (tick > 400)  # a leg follows what it was told a tick before
        q[:3] += speed[:3] * TICK * 1e-9
        shown = q + np.array([1e-5 * (tick // 4 % 2), 0.0, 0.0, 0.0, 0.0]) * (tick > 396)
        effort = drives_hold(tuple(shown), hand_of(felt * pushed))
        effort[:3] += 10.5 * (speed - before)[:3] / (TICK * 1e-9) + 60.0 * speed[:3]
        told = command * (tick > 400)
        detector.feed(tick * TICK, sense(shown, hand_of(5.0 * pushed)), tuple(shown), effort, tuple(told))
        objected |= detector.check(tick * TICK) is not None
    assert objected is objects


@pytest.mark.parametrize("items", [1, 4])
def test_what_the_drives_hold_against_an_encoder_that_jitters_is_no_hand(detector, items):
    """A leg is pulled to and fro by 14 N for a tick at each step, 0.11 N behind 0.25 s; 60 um at 5 mm/s take 12 ms."""
    q, command, step = np.zeros(5), np.array([5e-3, 5e-3, 5e-3, 0.0, 0.0]), np.eye(5)[0]
    for tick in range(440):
        shakes, wrench = tick > 390, hand_of(6.0 * (tick > 400))
        q[:3] += 5e-3 * TICK * 1e-9
        shown = q + 1e-5 * step * (tick // items % 2) * shakes
        effort = drives_hold(tuple(shown), wrench * 0.0)
        effort += 14.0 * shakes * (tick % items == 0) * (-1.0) ** (tick // items) * step
        effort[:3] += 60.0 * 5e-3
        detector.feed(tick * TICK, sense(shown, wrench), tuple(shown), effort, tuple(command))
        if detector.check(0) is not None:
            break
    assert (tick - 400) * TICK * 1e-9 <= 0.02 and detector.look(0).unit == "um"


def test_a_false_force_just_after_enabling_does_not_go_far(detector):
    """Before 0.09 s all travel counts: what the drives hold then is a weight. 6 N take the tip 60 um in 12 ms."""
    held, moved = np.array([0.0, 0.0, -1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1e-5, 0.0, 0.0, 0.0])
    for tick in range(200):
        false = tick >= 15
        detector.follow(tick * TICK, np.array([0.0, 0.0, 6.0 * false, 0.0, 0.0]), held, moved * false)
        if detector.check(tick * TICK) is not None:
            break
    assert (tick - 15) * TICK * 1e-9 == pytest.approx(0.012, abs=0.001) and detector.look(0).unit == "um"


def test_a_false_force_is_told_while_the_mean_is_not_known(detector):
    """6 N, 0.1 s after enabling: 0.65 N and the 0.2 N of a level are there behind 20 ms after 4 ms."""
    _, stamp = feel(detector, 0.1, 0.0, 0.0)
    objected, _ = feel(detector, 0.5, 6.0, 0.0, stamp)
    assert (objected - stamp) * 1e-9 <= 0.008


def test_numbers_that_are_none_are_not_judged(detector):
    feel(detector, 1.0, 0.0, 0.0)
    detector.feed(10**10, (np.nan,) * 6, (0.0,) * 5, (0.0,) * 5, STILL)
    detector.feed(10**10 + TICK, (0.0,) * 6, (0.0,) * 5, (np.nan,) * 5, STILL)
    assert detector.check(0) is None


@pytest.mark.parametrize("compared", [True, False])
def test_ticks_that_never_meet_stop_a_robot_that_moves(detector, compared):
    """Sensor and drives that are heard by turns are never compared: 30 ms of motion, from the last tick that was."""
    if compared:
        detector.feed(0, (0.0,) * 6, STILL, STILL, STILL)
    objected = []
    for stamp in range(0, 40_000_000, TICK):
        detector.move(stamp)
        if (found := detector.check(stamp)) is not None:
            objected.append((stamp, found.unit))
    stamp, unit = objected[0]
    assert 30_000_000 <= stamp <= 32_000_000 and unit == "s"
    detector.begin()
    detector.move(10**9)
    assert detector.check(10**9) is None
