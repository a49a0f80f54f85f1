"""Lines on a terminal, states in colour, and one status line below them that is written over."""

from __future__ import annotations

import os
import re
import shutil
import sys
from typing import TextIO

COLOURS = {"FAULT": 31, "refused": 33, "PAUSED": 33, "ENABLED": 32}
"""ANSI colour of a word: red, yellow, green."""
_WORDS = re.compile(rf"\b({'|'.join(COLOURS)})\b")


class Screen:
    """Prints lines to a stream; call it with one.

    On a terminal states have a colour (unless NO_COLOR is set) and there is a status line; elsewhere both are left out.
    """

    def __init__(self, stream: TextIO | None = None) -> None:
        """Take the stream, by default standard output."""
        self._stream = sys.stdout if stream is None else stream
        self._terminal = self._stream.isatty()
        self._painted = self._terminal and not os.environ.get("NO_COLOR")
        self._status = ""

    def __call__(self, text: str) -> None:
        """Print a line, above the status line where there is one."""
        if self._painted:
            text = _WORDS.sub(lambda word: f"\x1b[{COLOURS[word[0]]}m{word[0]}\x1b[0m", text, count=1)
        clear = "\r\x1b[K" if self._status else ""
        print(f"{clear}{text}", file=self._stream, flush=True)
        self._show()

    def status(self, text: str) -> None:
        """Write the status line anew; an empty text takes it away."""
        if self._terminal and text != self._status:
            self._status = text
            if not text:
                print("\r\x1b[K", end="", file=self._stream, flush=True)
            self._show()

    def _show(self) -> None:
        if self._status:
            width = shutil.get_terminal_size((100, 24)).columns
            print(f"\r{self._status[: width - 1]}\x1b[K", end="", file=self._stream, flush=True)
