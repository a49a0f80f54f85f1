"""Random histories of the supervisor with the law and its pedal, against a model that only remembers what was seen."""

import json

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule
from law_bench import PARAMETERS, LawBench
from sher3_common.operating_state import OperatingState, StateCommand
from sher3_common.reasons import ACTION, Action, Reason
from sher3_control import initial_state
from sher3_control.errors import StateCommandRefused
from sher3_control.nodes.heard import HeardState, status_of
from sher3_control.supervision.detectors import (
    EmergencyStopDetector,
    Finding,
    OverrunDetector,
    ReportedFault,
    SilenceDetector,
)
from sher3_control.supervision.supervisor import Status, Supervisor

S, C = OperatingState, StateCommand
STEP = 10_000_000
LIMIT = 0.05
FATAL = [reason for reason in Reason if ACTION[reason] >= Action.QUICK_STOP]


class History(RuleBasedStateMachine):
    """Commands, findings of every action, silence, pedal and time in any order."""

    def __init__(self):
        super().__init__()
        self.now = 10**9
        self.stream = SilenceDetector("force/measured_cf", LIMIT, Reason.WRENCH_MISSING, Reason.WRENCH_STALE, 10**9)
        self.button, self.drives, self.loop = EmergencyStopDetector(), ReportedFault("d", 0.03), OverrunDetector(0.1)
        self.supervisor = Supervisor([self.button, self.stream, self.drives, self.loop])
        self.heard, self.law, self.travel, self.out = HeardState(0.03), LawBench(), 0.0, None
        self.silent, self.ticks, self.bad, self.command_given = False, 0, 0, ""
        self.before, self.released = self.supervisor.status, False
        self.seen: set[str] = set()

    @initialize()
    def start(self):
        self.pass_time(1)

    # One period: streams, detectors, and the law with the pedal as it is.

    def pass_time(self, periods, command=""):
        for _ in range(periods):
            self.before, self.command_given = self.supervisor.status, ""
            self.now += STEP
            if not self.silent:
                self.stream.feed(self.now)
            if command:
                self.give(command)
                command = ""
            self.look()
            self.heard.feed(self.supervisor.status.heartbeat, self.now)
            enabled = self.heard.enabled(self.now)
            self.out = self.law.tick(force=(2.0, 0.0, 0.0), travel=self.travel, enabled=enabled)
            self.released = enabled and (self.released or self.travel == 0.0)

    def give(self, command):
        try:
            self.supervisor.command(command, self.now)
            self.command_given = command
            if self.before.state is not self.supervisor.state:
                self.seen = set()
        except StateCommandRefused as error:
            assert self.supervisor.status == self.before and error.command == command and str(error)

    def look(self):
        asked = self.supervisor.state
        found = {f.code for f in self.supervisor.findings(self.now, everything=asked is not S.DISABLED)}
        self.supervisor.check(self.now)
        if self.supervisor.status.first_fault is not None:
            entered = asked is not self.supervisor.state or self.seen == set()
            if entered and asked is S.PAUSED and self.supervisor.state is S.FAULT:
                self.seen = set()
            self.seen |= found
        else:
            self.seen = set()

    # Rules.

    @rule(periods=st.integers(1, 12))
    def wait(self, periods):
        self.pass_time(periods)

    @rule(command=st.sampled_from([c.value for c in C] + ["", "Enable", "enable ", "recover"]))
    def user_command(self, command):
        self.pass_time(1, command or "nothing")

    @rule(travel=st.sampled_from([0.0, 0.02, 0.5, 1.0]))
    def pedal(self, travel):
        self.travel = travel
        self.pass_time(1)

    @rule(pressed=st.booleans())
    def emergency(self, pressed):
        self.button.feed(pressed)
        self.pass_time(1)

    @rule(silent=st.booleans())
    def silence(self, silent):
        self.silent = silent
        self.pass_time(1)

    @rule(reason=st.sampled_from(FATAL), harder=st.sampled_from(Action))
    def drive_report(self, reason, harder):
        self.drives.feed(Finding(reason, 1.0, 0.0, "1", "motor_driver", harder), self.now)
        self.pass_time(1)

    @rule()
    def drive_well(self):
        self.drives.feed(None, self.now)
        self.pass_time(1)

    @rule(bad=st.integers(0, 60))
    def overruns(self, bad):
        self.ticks, self.bad = self.ticks + 100, self.bad + bad
        self.loop.feed("sher3/motor_driver", self.ticks, self.bad, self.now)
        self.pass_time(1)

    @precondition(lambda self: self.supervisor.state is S.DISABLED)
    @rule()
    def go(self):
        """What an operator does to move the robot: without it random histories seldom get there."""
        self.button.feed(False)
        self.silent, self.travel = False, 0.0
        self.drives.feed(None, self.now)
        self.pass_time(300)
        for command in ("disable", "home", "enable"):
            self.pass_time(1, command)
        self.pass_time(2)
        assert self.supervisor.state is S.ENABLED
        self.travel = 1.0
        self.pass_time(8)
        assert any(self.out.twist)

    # What never breaks.

    @invariant()
    def motion_only_enabled_and_rearmed(self):
        if self.out is not None and any(self.out.twist):
            assert self.supervisor.state is S.ENABLED and self.released and self.travel > 0.0
            assert not self.button.pressed

    @invariant()
    def never_enabled_or_paused_against_a_fault(self):
        found = self.supervisor.findings(self.now)
        if self.supervisor.state is S.ENABLED:
            assert not found
        if self.supervisor.state is S.PAUSED:
            assert all(f.action <= Action.PAUSE for f in found)

    @invariant()
    def only_commands_enable_and_recover(self):
        was, state = self.before.state, self.supervisor.state
        if state is S.ENABLED and was is not S.ENABLED:
            assert self.command_given in ("enable", "resume")
        if was is S.FAULT and state is not S.FAULT:
            assert self.command_given == "disable" and state is S.DISABLED
        if state is S.FAULT and was is S.FAULT:
            assert self.command_given == ""

    @invariant()
    def emergency_stop_dominates(self):
        if self.button.pressed:
            assert self.supervisor.state is S.FAULT and self.supervisor.status.action is Action.POWER_OFF

    @invariant()
    def first_kept_later_counted_hardest_wins(self):
        status, before = self.supervisor.status, self.before
        same = status.state is before.state and before.first_fault is not None and status.state is not S.DISABLED
        if same:
            assert status.first_fault == before.first_fault and status.since == before.since
            assert status.later_faults >= before.later_faults and status.action >= before.action
        if status.first_fault is None:
            assert status.later_faults == 0 and status.action is Action.NONE and status.state is not S.FAULT
        else:
            assert status.later_faults == len(self.seen) - 1 and status.reason == status.first_fault.code
            assert status.action >= status.first_fault.action

    @invariant()
    def since_is_monotone(self):
        assert self.before.since <= self.supervisor.status.since <= self.now
        if self.before.state is not self.supervisor.state:
            assert self.supervisor.status.since == self.now

    @invariant()
    def the_latched_status_survives_json(self):
        status = self.supervisor.status
        data = status_of(status.to_json())
        assert "\n" not in status.to_json() and data == json.loads(status.to_json())
        told, first = data["first_fault"], status.first_fault
        names = ("code", "value", "limit", "unit", "source")
        assert (told and tuple(told[name] for name in names)) == (first and (first.code, *first[1:5]))
        assert (S(data["state"]), data["since"], data["reason"]) == (status.state, status.since, status.reason)
        assert (data["later_faults"], Action[data["action"]]) == (status.later_faults, status.action)
        assert data["is_homed"] is status.homed
        state, action = status.heartbeat.split(" ")
        assert (S(state), Action[action]) == (status.state, status.action)


History.TestCase.settings = settings(max_examples=50, stateful_step_count=30, deadline=None, derandomize=True)
TestHistory = History.TestCase


def test_of_two_findings_in_one_check_the_harder_one_leads():
    """Whatever their order: no pause, and no quick stop, in place of a stop with power off."""
    now = 10**9
    loop = OverrunDetector(0.1)
    loop.feed("n", 100, 0, now)
    loop.feed("n", 200, 50, now)
    drives, button = ReportedFault("d"), EmergencyStopDetector(pressed=True)
    drives.feed(Finding(Reason.DRIVE_FELL, 1.0, 0.0, "1", "d"), now)
    for detectors in ([loop, drives, button], [button, drives, loop], [drives, loop, button]):
        status = Status(S.ENABLED, 0, "enable")
        supervisor = Supervisor(detectors, status)
        assert supervisor.check(now)
        assert supervisor.state is S.FAULT and supervisor.status.action is Action.POWER_OFF
        assert supervisor.status.reason == "EMERGENCY_STOP" and supervisor.status.later_faults == 2


def test_a_law_that_has_seen_nothing_is_not_armed():
    assert not initial_state().armed and PARAMETERS.release > 0.0


class NotANumber(SilenceDetector):
    def look(self, now):
        return Finding(self.stale, float("nan"), 1.0, "s", self.source)


def test_a_number_that_is_none_is_an_objection():
    detector = NotANumber("s", 1.0, Reason.WRENCH_MISSING, Reason.WRENCH_STALE)
    supervisor = Supervisor([detector], Status(S.ENABLED, 0, "enable"))
    assert supervisor.check(1) and supervisor.state is S.FAULT


def test_what_was_heard_of_the_supervisor_wears_off_and_damage_is_nothing():
    heard = HeardState(0.03)
    assert not heard.enabled(0)
    heard.feed("ENABLED NONE", 1000)
    assert heard.enabled(1000 + 30_000_000) and not heard.enabled(1001 + 30_000_000)
    heard.feed("ENABLED NONE", 10**9)
    heard.feed("PAUSED PAUSE", 10**9 + 1)
    assert not heard.enabled(10**9 + 2)
    for text in ("", "{", "[1]", "3", "null", "[" * 60_000):
        assert status_of(text) == {}, text
