"""What a node has heard from the others on text topics. Silence and damage count as the safe answer."""

from __future__ import annotations

from typing import Any

from sher3_common import FileError, OperatingState, parse_json
from sher3_common.stamps import nanoseconds


class HeardState:
    """The operating state as a node knows it, from `operating_state` and from the supervisor's heartbeats.

    Args:
        limit: silence after which the robot counts as not enabled [s].
    """

    def __init__(self, limit: float) -> None:
        self._patience = nanoseconds(limit)
        self._until = -1

    def feed(self, text: str, now: int) -> None:
        """Take note of an operating state, or of a heartbeat `STATE ACTION`, at time `now` [ns]."""
        self._until = now + self._patience if text.partition(" ")[0] == OperatingState.ENABLED else -1

    def enabled(self, now: int) -> bool:
        """Return whether the node has heard recently, at `now` [ns], that the robot is ENABLED."""
        return now <= self._until


def status_of(text: str) -> dict[str, Any]:
    """Return the fields of a status text; a damaged text has none."""
    try:
        data = parse_json(text)
    except FileError:
        return {}
    return data if isinstance(data, dict) else {}
