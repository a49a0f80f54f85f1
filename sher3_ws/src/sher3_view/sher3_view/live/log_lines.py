"""What deserves a line in the log of ROS: faults, refusals, nodes that complain; plain data, without ROS."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from sher3_view.live.snapshot import REFUSING, fault_text

WARNING, ERROR = 30, 40
"""Levels of `rcl_interfaces/Log`."""
SPEAKERS = {"supervisor/status": "supervisor", "motion/status": "kinematics", "admittance/status": "admittance"}
"""Node that a status is of."""


class Line(NamedTuple):
    """A line of the log: level, the name of the logger, and the text."""

    level: int
    name: str
    text: str


class LogLines:
    """Turns statuses and diagnostics into lines, each once while it lasts."""

    def __init__(self) -> None:
        self._last: dict[str, str] = {}

    def status(self, topic: str, status: Mapping[str, Any]) -> list[Line]:
        """Return the lines of a status: a new fault, a new refusal."""
        speaker, lines = SPEAKERS.get(topic, topic), []
        if topic in REFUSING:
            refused = status.get("refused") or {}
            lines += self._new(f"{topic} refused", WARNING, speaker, str(refused.get("text") or ""))
        fault = status.get("first_fault")
        if topic == "supervisor/status":
            text = f"{status.get('state')}: {fault_text(fault)}" if fault else ""
            lines += self._new("fault", ERROR if status.get("state") == "FAULT" else WARNING, speaker, text)
        return lines

    def diagnostic(self, name: str, level: int, message: str) -> list[Line]:
        """Return the line of a diagnostic: level 1 is a warning, 2 and 3 are errors. The supervisor has its status."""
        if name.startswith("supervisor"):
            return []
        speaker = name.removeprefix("sher3/").split(":")[0]
        text = f"{name}: {message}" if level else ""
        return self._new(f"diagnostic {name}", WARNING if level == 1 else ERROR, speaker, text)

    def _new(self, key: str, level: int, name: str, text: str) -> list[Line]:
        if self._last.get(key, "") == text:
            return []
        self._last[key] = text
        return [Line(level, f"sher3.{name}", text)] if text else []
