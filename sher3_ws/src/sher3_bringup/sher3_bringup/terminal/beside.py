"""The listener in a process of its own beside a run, and what its parent tells of it."""

from __future__ import annotations

import json
import socket
import time
from contextlib import suppress
from typing import Any

from sher3_common.progress import Say

from sher3_bringup.terminal.status_news import StatusNews

NAME = "terminal"
"""Of the process; the robot goes on without it."""
LARGEST = 1 << 16
"""Bytes of the longest status."""


class Beside:
    """Two ends of a wire: `make_nodes` runs in the process beside, `look` in the parent.

    Attributes:
        news: what was heard so far.
    """

    def __init__(self, say: Say, status: Say) -> None:
        """Take what prints a line and what writes the status line."""
        self.news = StatusNews()
        self._say, self._status = say, status
        self._ours, self._theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._ours.setblocking(False)
        self._theirs.setblocking(False)
        self._begin = time.monotonic()

    def make_nodes(self) -> list[Any]:
        """Return the listener; called in the process beside."""
        from sher3_bringup.terminal.listener_node import ListenerNode

        self._ours.close()
        return [ListenerNode(self._send)]

    def begin(self) -> None:
        """Count the seconds from now on."""
        self._theirs.close()
        self._begin = time.monotonic()

    def look(self) -> None:
        """Print what has come since the last call."""
        with suppress(BlockingIOError):
            while packet := self._ours.recv(LARGEST):
                for line in self.news.hear(*json.loads(packet)):
                    self._say(f"{time.monotonic() - self._begin:6.1f} s  {line}")
        self._status(self.news.status())

    def end(self) -> None:
        """Print what has come, and take the status line away."""
        self.look()
        self._status("")
        self._ours.close()

    def _send(self, topic: str, data: dict[str, Any]) -> None:
        # The parent reads every 50 ms; where it does not, it is better that a line is missing than that this waits.
        with suppress(OSError):
            self._theirs.send(json.dumps((topic, data)).encode())
