"""The operating state: every pair of the table, and random histories against the rules of the room."""

import itertools
import json

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule
from sher3_common.operating_state import OperatingState, StateCommand, next_state
from sher3_common.reasons import Reason
from sher3_control.errors import StateCommandRefused
from sher3_control.supervision.detectors import EmergencyStopDetector, Finding, ReportedFault, SilenceDetector
from sher3_control.supervision.supervisor import Supervisor

S, C = OperatingState, StateCommand
FELL = Finding(Reason.DRIVE_FELL, 1.0, 0.0, "1", "roll in FAULT")
CRTK = {
    "DISABLED": {"enable": "ENABLED", "disable": "DISABLED"},
    "ENABLED": {"enable": "ENABLED", "disable": "DISABLED", "pause": "PAUSED"},
    "PAUSED": {"disable": "DISABLED", "pause": "PAUSED", "resume": "ENABLED"},
    # CRTK lets a retry enable straight out of FAULT; here a fault is acknowledged with disable first.
    "FAULT": {"disable": "DISABLED"},
}


@pytest.mark.parametrize(("state", "command"), list(itertools.product(S, [C.ENABLE, C.DISABLE, C.PAUSE, C.RESUME])))
def test_every_pair_follows_the_crtk_table(state, command):
    after = next_state(state, command)
    assert (after.value if after else None) == CRTK[state.value].get(command.value)


def test_no_command_leads_into_fault_and_home_changes_no_state():
    assert all(next_state(s, c) is not S.FAULT for s, c in itertools.product(S, C))
    assert next_state(S.DISABLED, C.HOME) is S.DISABLED
    assert next_state(S.ENABLED, C.HOME) is None


def test_enable_names_every_failed_item():
    watched = [
        SilenceDetector("force/measured_cf", 0.1, Reason.WRENCH_MISSING, Reason.WRENCH_STALE),
        SilenceDetector("measured_js", 0.1, Reason.JOINTS_MISSING, Reason.JOINTS_STALE),
    ]
    supervisor = Supervisor(watched)
    with pytest.raises(StateCommandRefused, match=r"WRENCH_MISSING.*JOINTS_MISSING"):
        supervisor.command("enable", 0)
    for detector in watched:
        detector.feed(0)
    assert supervisor.command("enable", 10).state is S.ENABLED


def test_first_fault_is_kept_and_later_ones_are_counted():
    one, two = ReportedFault("drive 1"), ReportedFault("drive 2")
    supervisor = Supervisor([one, two])
    supervisor.command("enable", 0)
    one.finding = Finding(Reason.FOLLOWING_ERROR, 2.0, 1.0, "m", "drive 1")
    assert supervisor.check(5)
    two.finding = Finding(Reason.BUS_OFF, 3.0, 1.0, "m", "drive 2")
    assert supervisor.check(6)
    assert not supervisor.check(7)
    status = supervisor.status
    assert (status.state, status.since, status.reason, status.later_faults) == (S.FAULT, 5, "FOLLOWING_ERROR", 1)
    assert json.loads(status.to_json())["first_fault"]["unit"] == "m"


def test_recovery_needs_the_cause_gone_and_one_disable_is_spent_on_one_fault():
    button = EmergencyStopDetector()
    supervisor = Supervisor([button])
    supervisor.command("disable", 0)
    button.feed(True)
    supervisor.check(1)
    assert supervisor.state is S.FAULT
    with pytest.raises(StateCommandRefused, match="EMERGENCY_STOP"):
        supervisor.command("disable", 2)
    with pytest.raises(StateCommandRefused):
        supervisor.command("enable", 2)
    button.feed(False)
    assert not supervisor.check(3)
    assert supervisor.state is S.FAULT
    supervisor.command("disable", 4)
    button.feed(True)
    supervisor.check(5)
    assert supervisor.state is S.FAULT


def test_unhomed_robot_is_not_enabled():
    supervisor = Supervisor()
    supervisor.command("unhome", 0)
    with pytest.raises(StateCommandRefused, match="not homed"):
        supervisor.command("enable", 1)
    supervisor.command("home", 2)
    assert supervisor.command("enable", 3).state is S.ENABLED


def test_unknown_commands_are_refused_by_name():
    with pytest.raises(StateCommandRefused, match="self_destruct"):
        Supervisor().command("self_destruct", 0)


def test_a_drive_fault_faults_in_every_state_and_recovery_waits_for_the_reset():
    drive = ReportedFault("motor_driver")
    supervisor = Supervisor([drive])
    drive.feed(FELL, 0)
    assert supervisor.check(1)
    assert supervisor.state is S.FAULT
    assert supervisor.command("disable", 10**9).state is S.DISABLED
    drive.feed(FELL, 10**9 + 10**8)
    assert not supervisor.check(10**9 + 10**8)
    drive.feed(None, 10**9 + 2 * 10**8)
    drive.feed(FELL, 10**9 + 3 * 10**8)
    assert supervisor.check(10**9 + 3 * 10**8)
    assert supervisor.state is S.FAULT


class Histories(RuleBasedStateMachine):
    """Random commands, streams and faults; the rules that may never break are the invariants."""

    def __init__(self):
        super().__init__()
        self.now, self.accepted = 0, ""
        self.stream, self.button, self.drive = (
            SilenceDetector("s", 1.0, Reason.WRENCH_MISSING, Reason.WRENCH_STALE),
            EmergencyStopDetector(),
            ReportedFault("d"),
        )
        self.supervisor = Supervisor([self.button, self.stream, self.drive])
        self.before = self.supervisor.state

    def _advance(self):
        self.now += 10**8
        self.before, self.accepted = self.supervisor.state, ""

    @rule(command=st.sampled_from([c.value for c in C]))
    def command(self, command):
        self._advance()
        try:
            self.supervisor.command(command, self.now)
            self.accepted = command
        except StateCommandRefused:
            assert self.supervisor.state is self.before
        self.supervisor.check(self.now)

    @rule(pressed=st.booleans())
    def press(self, pressed):
        self._advance()
        self.button.feed(pressed)
        self.supervisor.check(self.now)

    @rule(alive=st.booleans(), steps=st.integers(1, 20))
    def wait(self, alive, steps):
        for _ in range(steps):
            self._advance()
            if alive:
                self.stream.feed(self.now)
            self.supervisor.check(self.now)

    @rule(faulty=st.booleans())
    def drive_fault(self, faulty):
        self._advance()
        self.drive.feed(FELL if faulty else None, self.now)
        self.supervisor.check(self.now)

    @invariant()
    def never_enabled_with_an_objection(self):
        if self.supervisor.state in (S.ENABLED, S.PAUSED):
            assert not self.supervisor.findings(self.now)

    @invariant()
    def enabled_only_by_command(self):
        if self.supervisor.state is S.ENABLED and self.before is not S.ENABLED:
            assert self.accepted in ("enable", "resume")

    @invariant()
    def fault_left_only_by_disable(self):
        if self.before is S.FAULT and self.supervisor.state is not S.FAULT:
            assert self.accepted == "disable"
            assert self.supervisor.state is S.DISABLED

    @invariant()
    def a_fault_keeps_its_first_cause(self):
        status = self.supervisor.status
        assert (status.state is S.FAULT) == (status.first_fault is not None)


Histories.TestCase.settings = settings(max_examples=60, stateful_step_count=30, deadline=None)
TestHistories = Histories.TestCase
