"""Whose turn it is to compile a function: processes that start together compile it once, not each for itself."""

from __future__ import annotations

import contextlib
import fcntl
import os
import time
from pathlib import Path

LONGEST = 240.0
"""Time [s] after which a process waits no longer: a function takes up to 90 s on a busy computer."""
LOOKS = 0.02
"""Time [s] between two looks whether the other one is done."""


class Turn:
    """A lock between processes; one that ends, however it does, leaves it.

    Args:
        path: of the file that stands for the function. Where it cannot be written, everybody compiles.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._file: int | None = None

    def take(self) -> None:
        """Wait until no other process has the turn, at most `LONGEST`; a process that has it goes on at once."""
        if self._file is not None:
            return
        end = time.monotonic() + LONGEST
        with contextlib.suppress(OSError):
            self._file = os.open(self._path, os.O_RDWR | os.O_CREAT)
            while time.monotonic() < end:
                with contextlib.suppress(BlockingIOError):
                    fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    return
                time.sleep(LOOKS)

    def leave(self) -> None:
        """Let the others go on."""
        if self._file is not None:
            fcntl.flock(self._file, fcntl.LOCK_UN)  # a forked process may have it open, too
            os.close(self._file)
            self._file = None
