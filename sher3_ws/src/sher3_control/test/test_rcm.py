"""The remote centre: the shaft stays on it while the tool turns, and a deviation decays at the stated rate."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_bench import ROBOT
from sher3_common.reasons import Reason
from sher3_control.errors import SettingsError
from sher3_control.motion.cooperative import CAPTURE_LIMIT, VelocityModes
from sher3_control.motion.rcm import HOLD_LIMIT, NO_HOLD, next_hold, rcm_velocity, shaft_deviation
from sher3_control.settings import MotionSettings
from sher3_kinematics import RobotKinematics
from sher3_sim.plant import Plant

SETTINGS = MotionSettings()
KINEMATICS = RobotKinematics(ROBOT)
PARAMETERS = np.array(KINEMATICS.parameters)
T = ROBOT.control_period
REST = (0.0,) * 5


def pose(q):
    transform = KINEMATICS.transform_tip_to_base(q)
    return transform[:3, :3], transform[:3, 3]


def deviation(q, centre):
    x, y, _ = shaft_deviation(*pose(q), centre)
    return np.hypot(x, y)


def test_drift_stays_below_a_micrometre_over_thirty_degrees():
    """Roll and tilt swing over +-30 degrees in 20 s while the needle moves 6 mm in and out, 500 Hz."""
    q = np.zeros(5)
    rotation, tip = pose(q)
    centre = tip + 0.018 * rotation[:, 2]
    angle, drift, seen = np.radians(30.0), 0.0, []
    for k in range(round(20.0 / T)):
        t = k * T
        roll_rate = angle * 2 * np.pi * 0.05 * np.cos(2 * np.pi * 0.05 * t)
        tilt_rate = angle * 2 * np.pi * 0.1 * np.cos(2 * np.pi * 0.1 * t)
        rotation, tip = pose(q)
        spin = np.array([roll_rate, 0.0, 0.0]) + tilt_rate * rotation[:, 1]
        insertion = -0.006 * 2 * np.pi * 0.05 * np.sin(2 * np.pi * 0.05 * t) * rotation[:, 2]
        twist = np.concatenate([np.cross(spin, tip - centre) + insertion, spin])
        velocity, *_ = rcm_velocity(PARAMETERS, q, twist, centre, NO_HOLD, 10.0, T)
        assert np.all(np.abs(velocity) <= KINEMATICS.velocity)
        q = q + T * velocity
        KINEMATICS.require_within_limits(q)
        drift = max(drift, deviation(q, centre))
        seen.append((q[3], KINEMATICS.tilt_linkage.angle(q[4])))
    roll, tilt = np.degrees(np.ptp(seen, axis=0))
    assert min(roll, tilt) > 59.0
    assert drift <= 1e-6


@given(st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6), st.floats(-0.5, 0.5), st.floats(-0.01, 0.01))
@settings(deadline=None, max_examples=50)
def test_any_request_keeps_the_shaft_on_the_centre(request_, roll, tilt):
    q = np.array([0.002, -0.003, 0.001, roll, tilt])
    rotation, tip = pose(q)
    centre = tip + 0.02 * rotation[:, 2]
    twist = np.array(request_) * np.repeat([0.005, 0.3], 3)
    velocity, *_ = rcm_velocity(PARAMETERS, q, twist, centre, NO_HOLD, 10.0, T)
    assert deviation(q + T * velocity, centre) < 1e-11


def test_a_request_about_the_centre_is_met_exactly():
    """Where the request keeps the centre by itself, the constrained twist is the request."""
    q = np.array([0.001, 0.0, -0.002, 0.2, 0.003])
    rotation, tip = pose(q)
    centre = tip + 0.02 * rotation[:, 2]
    spin = 0.1 * np.array([1.0, 0.0, 0.0]) - 0.07 * rotation[:, 1]
    twist = np.concatenate([np.cross(spin, tip - centre) + 0.002 * rotation[:, 2], spin])
    velocity, *_ = rcm_velocity(PARAMETERS, q, twist, centre, NO_HOLD, 0.0, 1e-9)
    assert KINEMATICS.jacobian(q) @ velocity == pytest.approx(twist, abs=1e-6)


def test_a_deviation_decays_at_the_gain():
    q = np.zeros(5)
    rotation, tip = pose(q)
    centre = tip + 0.02 * rotation[:, 2] + 5e-5 * rotation[:, 0]
    twist = np.array([0.0, 0.0, 1e-4, 0.0, 0.0, 0.0])
    before = deviation(q, centre)
    for _ in range(round(0.1 / T)):
        q = q + T * rcm_velocity(PARAMETERS, q, twist, centre, NO_HOLD, 10.0, T)[0]
    assert deviation(q, centre) / before == pytest.approx((1 - 10.0 * T) ** round(0.1 / T), rel=1e-3)


def test_centre_must_lie_on_the_shaft_and_no_force_is_no_motion():
    modes = VelocityModes(KINEMATICS, 10.0)
    on_shaft = modes.centre_behind_tip(0.018, REST)
    with pytest.raises(SettingsError, match="too far"):
        modes.set_centre((on_shaft[0] + 2 * CAPTURE_LIMIT, *on_shaft[1:]), REST)
    assert modes.centre is None
    with pytest.raises(SettingsError, match="finite"):
        modes.set_centre((float("nan"), 0.0, 0.0), REST)
    modes.set_centre((on_shaft[0] + 0.9 * CAPTURE_LIMIT, *on_shaft[1:]), REST)
    assert modes.from_twist(REST, (0.0,) * 6, REST).velocity == REST
    assert any(modes.from_twist(REST, (0.0, 0.0, 1e-4, 0.0, 0.0, 0.0), REST).velocity)


def test_a_shaft_that_left_the_centre_stops():
    modes = VelocityModes(KINEMATICS, 10.0)
    modes.set_centre(modes.centre_behind_tip(0.018, REST), REST)
    moved = (0.003, -0.002, 0.0, 0.0, 0.0)
    result = modes.from_twist(moved, (1e-3, 0.0, 0.0, 0.0, 0.0, 0.0), REST)
    assert (result.velocity, result.reason) == (REST, Reason.OFF_CENTRE)
    assert result.deviation > 1e-3


def test_a_shaft_off_the_centre_is_not_pulled_in_faster_than_stated():
    q = np.zeros(5)
    rotation, tip = pose(q)
    centre = tip + 0.02 * rotation[:, 2] + 5e-4 * rotation[:, 1]
    before = deviation(q, centre)
    q = q + T * rcm_velocity(PARAMETERS, q, np.zeros(6), centre, NO_HOLD, 50.0, T)[0]
    assert (before - deviation(q, centre)) / T == pytest.approx(1e-3, rel=1e-3)


def test_a_push_across_the_shaft_is_held_against_and_forgotten_at_rest():
    """Something moves the shaft at 100 um/s: the gain alone leaves 2 um, with the hold it goes to nothing."""

    def left(integral):
        modes, q, previous = VelocityModes(KINEMATICS, 50.0, integral), np.zeros(5), REST
        modes.set_centre(modes.centre_behind_tip(0.018, REST), REST)
        twist = (0.0, 0.0, 1e-4, 0.0, 0.0, 0.0)
        push = np.linalg.pinv(KINEMATICS.jacobian(q)) @ np.array([0.0, 1e-4, 0.0, 0.0, 0.0, 0.0])
        for _ in range(1000):
            previous = modes.from_twist(tuple(q.tolist()), twist, previous).velocity
            q = q + T * (np.array(previous) + push)
        return deviation(q, modes.centre), modes

    plain, _ = left(0.0)
    held, modes = left(500.0)
    assert plain == pytest.approx(2e-6, rel=0.1)
    assert held < 0.05e-6
    assert np.hypot(*modes.hold) == pytest.approx(1e-4, rel=0.1)
    modes.from_twist(REST, (0.0, 0.0, 1e-4, 0.0, 0.0, 0.0), REST)
    assert np.hypot(*modes.hold) < 1e-9


def test_the_hold_is_bounded():
    hold = NO_HOLD
    for _ in range(10_000):
        hold = next_hold(hold, 9e-4, -9e-4, 500.0, T)
    assert hold == (HOLD_LIMIT, -HOLD_LIMIT)


@pytest.mark.parametrize("turn", [(0.0, 1.0), (1.0, 0.0), (1.0, -1.0)])
def test_drift_on_the_plant_stays_below_a_micrometre_at_the_velocity_limits(turn):
    """Turned as fast as the drives may, up to 30 degrees: the encoders read the true shaft within a micrometre."""
    modes, q, previous = VelocityModes(KINEMATICS, SETTINGS.rcm_gain, SETTINGS.rcm_integral), REST, REST
    plant, drift, fastest = Plant(ROBOT), 0.0, 0.0
    plant.reset(np.zeros(5))
    modes.set_centre(modes.centre_behind_tip(0.018, q), q)
    for k in range(round(1.2 / T)):
        rotation, tip = pose(q)
        rates = np.array(turn) * 3.0 * min(1.0, k * T / 0.3)
        spin = np.array([rates[0], 0.0, 0.0]) + rates[1] * rotation[:, 1]
        twist = np.concatenate([np.cross(spin, tip - modes.centre), spin])
        previous = modes.from_twist(q, tuple(twist.tolist()), previous).velocity
        q = tuple(plant.step(previous).load_position.tolist())
        if max(abs(q[3]), abs(KINEMATICS.tilt_linkage.angle(q[4]))) > np.radians(30.0):
            break
        drift = max(drift, deviation(plant.true_position, modes.centre))
        fastest = max(fastest, np.max(np.abs(previous) / KINEMATICS.velocity))
    assert fastest > 0.999
    assert drift <= 1e-6
