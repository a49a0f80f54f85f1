"""Detectors and what the supervisor makes of them: numbers with limits, severity, pause, the slipped leg."""

import json

import numpy as np
import pytest
from law_bench import ROBOT
from sher3_common.operating_state import OperatingState
from sher3_common.reasons import Action, Reason
from sher3_control.errors import StateCommandRefused
from sher3_control.settings import SupervisorSettings
from sher3_control.supervision.detectors import Finding, OverrunDetector, ReportedFault, SilenceDetector, TwinDetector
from sher3_control.supervision.driver_reports import cycle_counts, driver_stop
from sher3_control.supervision.leg_residual import LegDetector, leg_residual
from sher3_control.supervision.supervisor import Supervisor
from sher3_kinematics import RobotKinematics

S = OperatingState
KINEMATICS = RobotKinematics(ROBOT)
Q = (0.003, -0.002, 0.001, 0.2, -0.005)
MS = 1_000_000


def fault(reason):
    return Finding(reason, 2.0, 1.0, "m", "test")


def enabled(*detectors):
    supervisor = Supervisor(detectors)
    supervisor.command("enable", 0)
    return supervisor


def test_a_second_publisher_of_a_stream_of_its_own_stops_the_robot():
    """And it is not enabled again until the twin has gone; nobody at all is the business of the silence detectors."""
    twins = TwinDetector()
    supervisor = enabled(twins)
    for counts in ({}, {"servo_jv": 1, "pedal/measured": 0}):
        twins.feed(counts)
        assert not supervisor.check(1) and supervisor.state is S.ENABLED
    twins.feed({"pedal/measured": 2})
    twins.feed({"servo_jv": 1})  # asked in turn: what was found of the others stays
    assert supervisor.check(2) and supervisor.state is S.FAULT
    first = supervisor.status.first_fault
    assert (first.code, first.value, first.source, first.unit) == ("PUBLISHED_TWICE", 2, "pedal/measured", "publishers")
    assert supervisor.status.action is Action.QUICK_STOP
    supervisor.command("disable", 3)
    with pytest.raises(StateCommandRefused, match="PUBLISHED_TWICE: pedal/measured 2 publishers, limit 1"):
        supervisor.command("enable", 4)
    twins.feed({"pedal/measured": 1})
    supervisor.command("enable", 5)


def test_the_most_severe_of_several_objections_comes_first():
    one, two = ReportedFault("a"), ReportedFault("b")
    supervisor = enabled(one, two)
    one.feed(fault(Reason.BUS_OFF), 1)
    two.feed(fault(Reason.ENCODERS_DISAGREE), 1)
    assert supervisor.check(1)
    status = supervisor.status
    assert (status.reason, status.action, status.later_faults) == ("ENCODERS_DISAGREE", Action.POWER_OFF, 1)
    assert status.heartbeat == "FAULT POWER_OFF"


def test_a_later_more_severe_fault_raises_the_action_and_keeps_the_first():
    one, two = ReportedFault("a"), ReportedFault("b")
    supervisor = enabled(one, two)
    one.feed(fault(Reason.BUS_OFF), 1)
    supervisor.check(1)
    two.feed(fault(Reason.STOP_NOT_OBEYED), 2)
    assert supervisor.check(2)
    status = supervisor.status
    assert (status.reason, status.since, status.action) == ("BUS_OFF", 1, Action.POWER_OFF)
    one.feed(None, 3)
    assert not supervisor.check(3)
    assert supervisor.status.action is Action.POWER_OFF, "nothing takes an action back but a recovery"
    assert json.loads(status.to_json())["first_fault"]["code"] == "BUS_OFF"


def test_a_harder_action_of_the_driver_is_taken_over():
    drive = ReportedFault("motor_driver")
    supervisor = enabled(drive)
    drive.feed(fault(Reason.BUS_OFF)._replace(harder=Action.POWER_OFF), 1)
    supervisor.check(1)
    assert supervisor.status.heartbeat == "FAULT POWER_OFF"


def test_overruns_pause_and_a_fault_takes_over_from_there():
    overruns, drive = OverrunDetector(0.1), ReportedFault("motor_driver")
    supervisor = enabled(overruns, drive)
    for k, bad in enumerate((50, 60, 200)):
        overruns.feed("sher3/admittance", 500 * (k + 1), bad, k * 1000 * MS)
        assert supervisor.check(k * 1000 * MS) == (k == 2)
    status = supervisor.status
    assert (status.state, status.reason, status.heartbeat) == (S.PAUSED, "OVERRUN", "PAUSED PAUSE")
    assert status.first_fault.value == pytest.approx(140 / 500)
    with pytest.raises(StateCommandRefused, match="OVERRUN"):
        supervisor.command("resume", 2100 * MS)
    assert not supervisor.check(2200 * MS)
    drive.feed(fault(Reason.DRIVE_SILENT), 2300 * MS)
    assert supervisor.check(2300 * MS)
    assert supervisor.state is S.FAULT
    drive.feed(None, 2400 * MS)
    supervisor.command("disable", 2400 * MS)
    assert supervisor.status.action is Action.NONE and supervisor.status.first_fault is None


def test_after_the_overruns_the_surgeon_resumes():
    overruns = OverrunDetector(0.1)
    supervisor = enabled(overruns)
    for k, bad in enumerate((0, 200, 200)):
        overruns.feed("sher3/pedal", 500 * (k + 1), bad, k * 1000 * MS)
        supervisor.check(k * 1000 * MS)
    assert supervisor.state is S.PAUSED, "it does not resume by itself"
    assert supervisor.command("resume", 2000 * MS).state is S.ENABLED


def test_a_stream_that_never_came_differs_from_one_that_fell_silent():
    detector = SilenceDetector("measured_js", 0.1, Reason.JOINTS_MISSING, Reason.JOINTS_STALE)
    assert detector.check(0).reason is Reason.JOINTS_MISSING
    detector.feed(5)
    assert detector.check(5 + 100 * MS) is None
    found = detector.check(5 + 100 * MS + 1)
    assert found.reason is Reason.JOINTS_STALE and found.value == pytest.approx(0.1)


def test_a_report_of_the_driver_keeps_its_reason_number_and_action():
    values = (("reason", "BUS_OFF"), ("action", "POWER_OFF"), ("BUS_OFF stop [1]", "3 limit 2"))
    found = driver_stop(2, "stopped: bus off", values)
    assert found == Finding(Reason.BUS_OFF, 3.0, 2.0, "1", "motor_driver: stopped: bus off", Action.POWER_OFF)
    assert driver_stop(1, "lost frames", values) is None


@pytest.mark.parametrize("values", [(), (("reason", "NONSENSE"),), (("reason", "BUS_OFF"), ("BUS_OFF stop [1]", "x"))])
def test_a_damaged_report_of_a_stop_still_is_a_stop(values):
    assert driver_stop(2, "?", values).action >= Action.QUICK_STOP
    assert cycle_counts(values) is None
    assert cycle_counts((("ticks", "5"), ("lost_cycles", "1"), ("overruns", "2"))) == (6, 3)


@pytest.mark.parametrize("leg", range(3))
def test_the_slip_of_one_leg_is_localised_from_the_tip(leg):
    slipped = np.array(Q)
    slipped[leg] += 2e-4
    off = (KINEMATICS.transform_tip_to_base(slipped) - KINEMATICS.transform_tip_to_base(np.array(Q)))[:3, 3]
    found = leg_residual(KINEMATICS, Q, off)
    assert found.leg == leg and found.sliders[leg] == pytest.approx(2e-4, rel=0.05)


def test_a_shift_of_the_whole_tip_is_no_leg():
    assert leg_residual(KINEMATICS, Q, np.array([0.0, 0.0, 1e-3])).leg is None


def leg_detector():
    return LegDetector(KINEMATICS, SupervisorSettings())


def play(detector, slip, seconds, start=0):
    """Feed tracked tips at 100 Hz whose robot has leg 2 off by `slip` [m] from the load encoders; return findings."""
    rng, found = np.random.default_rng(1), []
    for k in range(round(seconds * 100)):
        true = np.array(Q)
        true[1] += slip
        tip = KINEMATICS.transform_tip_to_base(true)[:3, 3] + 2e-6 * rng.standard_normal(3)
        now = start + k * 10 * MS
        detector.feed(now, tuple(tip), Q)
        found.append(detector.check(now))
    return found


def test_the_detector_waits_for_its_latency_and_names_the_leg():
    detector = leg_detector()
    assert not any(play(detector, 0.0, 0.5))
    found = play(detector, 2e-3, 0.3, start=500 * MS)
    first = next(k for k, finding in enumerate(found) if finding)
    assert 10 <= first <= 12 and found[first].source == "delta_2" and found[first].reason is Reason.LEG_SLIPPED
    detector.recover(0)
    assert not any(play(detector, 2e-3, 0.3, start=900 * MS)), "recovery takes the present tip as right"


def test_deflection_and_noise_below_the_limit_are_no_slip():
    detector = leg_detector()
    assert not any(play(detector, 0.0, 0.5) + play(detector, 5e-4, 2.0, start=500 * MS))
    assert detector.look(0).value < 1e-3
