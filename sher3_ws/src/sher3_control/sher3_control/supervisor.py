"""The core of the supervisor: who may move, decided from commands and detectors, with time as an argument.

The first fault is kept with its time, later ones are counted; of all of them the most severe action is in force.
Nothing leaves FAULT by itself: one `disable`, accepted only once its causes are gone, leads to DISABLED; `enable`
needs every detector silent. Release-then-press of the pedal is the law's own part, since every stop disarms it.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field

from .detectors import Detector, Finding
from .errors import StateCommandRefused
from .operating_state import OperatingState, StateCommand, next_state
from .reasons import Action


@dataclass(frozen=True)
class Status:
    """The operating state with its history.

    Attributes:
        since: time of the last change of state [ns].
        reason: what led here: the command, or the code of the first fault.
        first_fault: the fault that led into FAULT, kept until recovery; what paused the robot in PAUSED.
        later_faults: how many other objections followed it.
        action: how hard the robot is stopped.
        homed: the absolute encoders make the robot homed; `unhome` revokes it until `home`.
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
        """What `supervisor/heartbeat` carries: `STATE ACTION`."""
        return f"{self.state.value} {self.action.name}"


@dataclass
class Supervisor:
    """The state machine around `TRANSITIONS`; call `check` every tick and `command` on user commands."""

    detectors: Sequence[Detector] = ()
    status: Status = field(default_factory=lambda: Status(OperatingState.DISABLED, 0, "start"))
    _seen: set[str] = field(default_factory=set)

    @property
    def state(self) -> OperatingState:
        """The present operating state."""
        return self.status.state

    def findings(self, now: int, everything: bool = True) -> list[Finding]:
        """Return all present objections, or only those of the detectors that are `active_when_disabled`."""
        asked = [d for d in self.detectors if everything or d.active_when_disabled]
        return [finding for d in asked if (finding := d.check(now)) is not None]

    def check(self, now: int) -> bool:
        """Ask the detectors; return whether the status changed."""
        found = self.findings(now, everything=self.state is not OperatingState.DISABLED)
        if self.state is OperatingState.FAULT:
            return self._count(found)
        if not found:
            return False
        return self._stop(now, found)

    def command(self, text: str, now: int) -> Status:
        """Carry out one CRTK state command.

        Raises:
            StateCommandRefused: unknown command, not allowed in this state, or a detector objects.
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
            self.status = _replace(self.status, homed=command is StateCommand.HOME)
        elif target is not state:
            self._seen.clear()
            if self.state is OperatingState.FAULT:
                for detector in self.detectors:
                    detector.recover(now)
            self.status = Status(target, now, text, homed=self.status.homed)
        return self.status

    def _self_check(self, command: StateCommand, now: int) -> None:
        """Refuse to enable, resume or recover while anything objects, naming every item."""
        if command is StateCommand.DISABLE and self.state is not OperatingState.FAULT:
            return
        if command in (StateCommand.ENABLE, StateCommand.RESUME, StateCommand.DISABLE):
            found = self._objections(command, now)
            if found:
                listing = "; ".join(map(str, found))
                raise StateCommandRefused(command.value, self.state.value, listing, remedy="remove these causes first")
        if command is StateCommand.ENABLE and not self.status.homed:
            raise StateCommandRefused(command.value, self.state.value, "not homed", remedy="send home first")

    def _objections(self, command: StateCommand, now: int) -> list[Finding]:
        """Return what stands against a command; against recovery only what would be a fault in DISABLED at once."""
        recovery = command is StateCommand.DISABLE
        asked = [d for d in self.detectors if not recovery or (d.active_when_disabled and not d.cleared_by_recovery)]
        return [finding for d in asked if (finding := d.check(now)) is not None]

    def _stop(self, now: int, found: list[Finding]) -> bool:
        """Go to FAULT, or to PAUSED for what only asks for that; return whether anything changed."""
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
        """Count what is new, and take its action over when it is more severe."""
        new = {f.code for f in found} - self._seen
        self._seen |= new
        action = max((self.status.action, *(f.action for f in found)))
        changed = bool(new) or action > self.status.action
        if changed:
            later = self.status.later_faults + len(new)
            self.status = _replace(self.status, later_faults=later, action=action)
        return changed


_REMEDY = {
    OperatingState.DISABLED: "send enable first",
    OperatingState.ENABLED: "send pause or disable",
    OperatingState.PAUSED: "send resume or disable",
    OperatingState.FAULT: "remove the cause, send disable, then enable",
}


def _replace(status: Status, **changes: object) -> Status:
    return Status(**{**vars(status), **changes})  # type: ignore[arg-type]
