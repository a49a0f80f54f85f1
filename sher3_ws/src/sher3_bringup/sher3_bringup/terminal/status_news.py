"""What is said of a running robot, from its statuses: plain data, without ROS and terminal."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from sher3_common.operating_state import OperatingState
from sher3_common.reasons import ACTION, TEXT, Action, Reason
from sher3_common.remedies import RECOVER, remedy
from sher3_view.live.snapshot import REFUSING, fault_text

STATE, LAW, MOTION, DIAGNOSTICS = "supervisor/status", "admittance/status", "motion/status", "diagnostics"
SOURCES = (STATE, LAW, MOTION, DIAGNOSTICS)
"""Topics that are listened to; none of them is a stream of the control loop, so nothing is sent more often for it."""
FORCE, SPEED, LOST = "force [N]", f"{Reason.TIP_SPEED.name} tip [m/s]", "lost_cycles"
"""Keys of the numbers in diagnostics."""
UNKNOWN = "unknown"
NEXT = {OperatingState.FAULT: RECOVER, OperatingState.PAUSED: "then send resume"}
"""How a state that the robot went to by itself is left when the cause is gone."""


class StatusNews:
    """What was heard of the robot, and what is new in it.

    Attributes:
        state: the operating state, `unknown` before the first status.
        fault: why the robot is in FAULT, as one line; empty in any other state.
    """

    def __init__(self) -> None:
        self.state, self.fault = UNKNOWN, ""
        self._since: object = None
        self._refused: dict[str, str] = {}
        self._mode, self._why = "", ""
        self._law: tuple[str, object] | None = None
        self._objected = ""
        self._force = self._speed = math.nan
        self._lost: dict[str, int] = {}

    def hear(self, topic: str, data: Mapping[str, Any]) -> list[str]:
        """Take the content of a topic of `SOURCES`; return the lines that are to be printed, most often none.

        Args:
            topic: of the table.
            data: object of a status, or `name` and `values` of a diagnostic.
        """
        if topic == DIAGNOSTICS:
            self._note(str(data["name"]), dict(data["values"]))
            return []
        lines = self._new_refusal(topic, data) if topic in REFUSING else []
        if topic == STATE:
            return self._new_state(data) + lines
        if topic == MOTION:
            self._mode = str(data.get("mode") or "")
        else:
            self._why = str(data.get("text", ""))
            lines += self._objection(data)
        return lines

    def status(self) -> str:
        """Return the status line: state, mode or what keeps the robot at rest, force, speed, lost cycles."""
        mode = self._mode or (self._why if self.state == OperatingState.ENABLED else "")
        numbers = [
            f"force {self._force:.2f} N" if math.isfinite(self._force) else "",
            f"tip {self._speed * 1e3:.2f} mm/s" if math.isfinite(self._speed) else "",
            f"lost cycles {sum(self._lost.values())}",
        ]
        return "   ".join(part for part in (self.state, mode, *numbers) if part)

    def _new_state(self, data: Mapping[str, Any]) -> list[str]:
        if (data["state"], data["since"]) == (self.state, self._since):
            return []
        self.state, self._since, self._objected = str(data["state"]), data["since"], ""
        line = state_line(data)
        self.fault = line if self.state == OperatingState.FAULT else ""
        return [line]

    def _objection(self, data: Mapping[str, Any]) -> list[str]:
        """Return why an enabled robot does not follow a hand, each reason once until the state changes.

        The status comes once a second and at each change: what it says twice lasts.
        """
        law = str(data.get("reason")), data.get("since")
        lasts, self._law = law == self._law, law
        reason = Reason.__members__.get(law[0], Reason.MOVING)
        enabled, known = self.state == OperatingState.ENABLED, law[0] == self._objected
        if known or not (lasts and enabled and ACTION[reason] > Action.ZERO):
            return []
        self._objected = law[0]
        return [f"at rest  {reason.name}: {TEXT[reason]}; {remedy(reason)}"]

    def _new_refusal(self, topic: str, data: Mapping[str, Any]) -> list[str]:
        """Return a refusal that came since the first status of a topic: that one may hold what was refused before."""
        refused = data.get("refused")
        text = "" if not isinstance(refused, Mapping) else str(refused.get("text") or refused)
        before, self._refused[topic] = self._refused.get(topic, text), text
        return [f"refused  {text}"] if text and text != before else []

    def _note(self, name: str, values: Mapping[str, str]) -> None:
        if (count := values.get(LOST, "")).isdigit():
            self._lost[name] = int(count)
        self._force = _number(values.get(FORCE), self._force)
        self._speed = _number(values.get(SPEED), self._speed)


def state_line(status: Mapping[str, Any]) -> str:
    """Return what a supervisor's status says as one line: state, reason with its numbers, remedy."""
    state, fault = str(status["state"]), status.get("first_fault")
    if not fault:
        return f"{state}  by {status['reason']}"
    code = str(fault.get("code"))
    parts = [fault_text(fault)]
    if code in Reason.__members__:
        reason = Reason[code]
        parts += [TEXT[reason], str(fault.get("remedy") or remedy(reason, str(fault.get("source", ""))))]
    if state in NEXT:
        parts[-1] = f"{parts[-1]}, {NEXT[OperatingState(state)]}"
    return f"{state}  {'; '.join(parts)}"


def _number(text: str | None, otherwise: float) -> float:
    """Return the number that a reading begins with (see `sher3_common.reasons.reading`)."""
    try:
        return float(text.split()[0]) if text else otherwise
    except ValueError:
        return otherwise
