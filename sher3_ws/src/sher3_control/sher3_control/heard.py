"""What a node has heard of the others on latched text topics; silence and damage count as the safe answer."""

from __future__ import annotations

from typing import Any

from sher3_description import FileError, parse_json

PERIODS = 2.5
"""The operating state is repeated; after this many silent periods the robot counts as not enabled."""


class HeardState:
    """The operating state as a node knows it."""

    def __init__(self, publish_period: float) -> None:
        self._patience = round(PERIODS * publish_period * 1e9)
        self._until = -1

    def feed(self, text: str, now: int) -> None:
        """Take note of an `operating_state` sample at time `now` [ns]."""
        self._until = now + self._patience if text == "ENABLED" else -1

    def enabled(self, now: int) -> bool:
        """Return whether the robot is ENABLED, heard of recently."""
        return now <= self._until


def status_of(text: str) -> dict[str, Any]:
    """Return the fields of a status text; a damaged one has none."""
    try:
        data = parse_json(text)
    except FileError:
        return {}
    return data if isinstance(data, dict) else {}
