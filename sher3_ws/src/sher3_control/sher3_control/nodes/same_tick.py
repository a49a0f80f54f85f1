"""Samples of several streams, put together by their stamps."""

from __future__ import annotations

from typing import Any

KEPT = 64
"""Samples of a stream that wait for those of the others, at most."""


class SameTick:
    """Gives the samples of a tick once all streams have one.

    Args:
        streams: their names.
    """

    def __init__(self, *streams: str) -> None:
        self._waiting: dict[str, dict[int, Any]] = {name: {} for name in streams}

    def put(self, name: str, sample: Any) -> None:
        """Take a sample of a stream."""
        waiting = self._waiting[name]
        waiting[sample.stamp] = sample
        if len(waiting) > KEPT:
            del waiting[min(waiting)]

    def take(self) -> list[tuple[Any, ...]]:
        """Return the samples of each complete tick, in the order of the streams, the oldest tick first."""
        first, *others = self._waiting.values()
        stamps = sorted(set(first).intersection(*others))
        return [tuple(waiting.pop(stamp) for waiting in self._waiting.values()) for stamp in stamps]
