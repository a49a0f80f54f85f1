"""Progress of long work, told line by line to whoever asked for it."""

from __future__ import annotations

from collections.abc import Callable

Say = Callable[[str], None]
"""What takes a line of progress."""


def silent(line: str) -> None:
    """Drop a line of progress."""
