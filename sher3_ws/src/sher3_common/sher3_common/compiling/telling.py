"""Say that code is being compiled: the first use of a law takes seconds, and nobody should wonder why."""

from __future__ import annotations

import sys
import time
from typing import TextIO

UNNOTICED = 1.0
"""Seconds of compiling that nobody need be told of."""
CLEAR = "\r\x1b[K"
"""Empties the line of a terminal."""


class Telling:
    """Tells on a stream what is compiled: how much so far on a terminal, one line elsewhere.

    Args:
        stream: where to; the standard error of the moment by default.
    """

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = stream
        self._open = self._count = 0
        self._begun = 0.0
        self._announced = False

    def begins(self) -> None:
        """Take note that a function is compiled from now on; others that it calls may be compiled meanwhile."""
        now = time.monotonic()
        self._begun = self._begun or now
        self._open, self._count = self._open + 1, self._count + 1
        passed = now - self._begun
        stream = self._stream or sys.stderr
        if passed < UNNOTICED:
            return
        if stream.isatty():
            stream.write(f"{CLEAR}compiling, once: {self._count} functions, {passed:.0f} s")
        elif not self._announced:
            stream.write("sher3: compiling, once; the next start takes it from the cache\n")
        self._announced = True
        stream.flush()

    def ended(self) -> None:
        """Take note that a function is compiled; the line goes with the last one."""
        self._open = max(0, self._open - 1)
        stream = self._stream or sys.stderr
        if self._announced and self._open == 0 and stream.isatty():
            stream.write(CLEAR)
            stream.flush()


TELLING = Telling()
"""Of this process."""
