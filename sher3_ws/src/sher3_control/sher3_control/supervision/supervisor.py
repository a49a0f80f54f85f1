"""The core of the supervisor: whether the robot may move, decided from commands and detectors; time is an argument.

The first fault is kept with its time, and later ones are counted. The most severe action of all of them is in force.
The robot never leaves FAULT by itself. `disable` leads to DISABLED, and is accepted only once the causes are gone;
`enable` is accepted only while no detector objects. That the pedal must be released and pressed after a stop is the
business of the law, which every stop disarms.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from sher3_common.operating_state import OperatingState, StateCommand, heartbeat_text, next_state
from sher3_common.reasons import Action

from sher3_control.errors import StateCommandRefused
from sher3_control.supervision.detectors import Detector, Finding


@dataclass(frozen=True)
class Status:
    """The operating state with its history.

    Attributes:
        state: the operating state.
        since: time of the last change of state [ns].
        reason: what led to the state: a command, or the code of the first fault.
        first_fault: the finding that led into FAULT, or that paused the robot; kept until the state is left.
        later_faults: how many findings of other codes followed it.
        action: how hard the robot is stopped.
        homed: the absolute encoders make the robot homed from the start; `unhome` revokes it until `home`.
    """

    state: OperatingState
    since: int
    reason: str
    first_fault: Finding | None = None
    later_faults: int = 0
    action: Action = Action.NONE
    homed: bool = True

    def to_json(self) -> str:
        """Return the status as one line of JSON, times in ns."""
        fault = None if self.first_fault is None else self.first_fault.to_dict()
        data = {"state": self.state.value, "since": self.since, "reason": self.reason, "first_fault": fault}
        action = self.action.name
        return json.dumps({**data, "later_faults": self.later_faults, "action": action, "is_homed": self.homed})

    @property
    def heartbeat(self) -> str:
        """The text on `supervisor/heartbeat`."""
        return heartbeat_text(self.state, self.action)


@dataclass
class Supervisor:
    """The state machine around `TRANSITIONS`; call `check` at every tick and `command` for every command.

    Attributes:
        detectors: what is watched.
        status: operating state and history.
    """

    detectors: Sequence[Detector] = ()
    status: Status = field(default_factory=lambda: Status(OperatingState.DISABLED, 0, "start"))
    _seen: set[str] = field(default_factory=set)

    @property
    def state(self) -> OperatingState:
        """The present operating state."""
        return self.status.state

    def findings(self, now: int, everything: bool = True) -> list[Finding]:
        """Return the objections at `now` [ns]: all, or only those of detectors that are `active_when_disabled`."""
        asked = [d for d in self.detectors if everything or d.active_when_disabled]
        return [finding for d in asked if (finding := d.check(now)) is not None]

    def check(self, now: int) -> bool:
        """Ask the detectors at the time `now` [ns]; return whether the status changed."""
        found = self.findings(now, everything=self.state is not OperatingState.DISABLED)
        if self.state is OperatingState.FAULT:
            return self._count(found)
        if not found:
            return False
        return self._stop(now, found)

    def command(self, text: str, now: int) -> Status:
        """Carry out one CRTK state command at the time `now` [ns]; return the status after it.

        Raises:
            StateCommandRefused: the command is unknown or not allowed in this state, or a detector objects.
        """
        state = self.state
        try:
            command = StateCommand(text)
        except ValueError:
            known = ", ".join(c.value for c in StateCommand)
            raise StateCommandRefused(text, state.value, "unknown command", remedy=f"use one of {known}") from None
        target = next_state(state, command)
        if target is None:
            raise StateCommandRefused(text, state.value, "not allowed in this state", remedy=_REMEDY.get(state))
        self._self_check(command, now)
        if command in (StateCommand.HOME, StateCommand.UNHOME):
            self.status = replace(self.status, homed=command is StateCommand.HOME)
        elif target is not state:
            self._seen.clear()
            if self.state is OperatingState.FAULT:
                for detector in self.detectors:
                    detector.recover(now)
            self.status = Status(target, now, text, homed=self.status.homed)
        return self.status

    def _self_check(self, command: StateCommand, now: int) -> None:
        """Refuse to enable, to resume or to leave FAULT while any detector objects; the error names all findings."""
        if command is StateCommand.DISABLE and self.state is not OperatingState.FAULT:
            return
        if command in (StateCommand.ENABLE, StateCommand.RESUME, StateCommand.DISABLE):
            found = self._objections(command, now)
            if found:
                listing = "; ".join(map(str, found))
                remedy = "; ".join(dict.fromkeys(finding.remedy for finding in found))
                raise StateCommandRefused(command.value, self.state.value, listing, remedy=remedy)
        if command is StateCommand.ENABLE and not self.status.homed:
            raise StateCommandRefused(command.value, self.state.value, "not homed", remedy="send home first")

    def _objections(self, command: StateCommand, now: int) -> list[Finding]:
        """Return the findings against a command; against leaving FAULT only those that would be a fault in DISABLED."""
        recovery = command is StateCommand.DISABLE
        asked = [d for d in self.detectors if not recovery or (d.active_when_disabled and not d.cleared_by_recovery)]
        return [finding for d in asked if (finding := d.check(now)) is not None]

    def _stop(self, now: int, found: list[Finding]) -> bool:
        """Go to FAULT, or to PAUSED when no finding asks for more; return whether the status changed."""
        first = max(found, key=lambda finding: finding.action)
        target = OperatingState.PAUSED if first.action <= Action.PAUSE else OperatingState.FAULT
        if target is self.state and self.status.first_fault is not None:
            return self._count(found)
        since = self.status.since if target is self.state else now
        self._seen = {f.code for f in found}
        later = len(self._seen) - 1
        self.status = Status(target, since, first.code, first, later, first.action, self.status.homed)
        return True

    def _count(self, found: list[Finding]) -> bool:
        """Count new findings, and take over a more severe action; return whether the status changed."""
        new = {f.code for f in found} - self._seen
        self._seen |= new
        action = max((self.status.action, *(f.action for f in found)))
        changed = bool(new) or action > self.status.action
        if changed:
            later = self.status.later_faults + len(new)
            self.status = replace(self.status, later_faults=later, action=action)
        return changed


_REMEDY = {
    OperatingState.DISABLED: "send enable first",
    OperatingState.ENABLED: "send pause or disable",
    OperatingState.PAUSED: "send resume or disable",
    OperatingState.FAULT: "remove the cause, send disable, then enable",
}
