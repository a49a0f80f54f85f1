"""Processes that the tests start."""

from __future__ import annotations

import sys


def sher3_command(*arguments: str) -> list[str]:
    """Return the command line of a `sher3` command in the interpreter of the tests."""
    return [sys.executable, "-m", "sher3_cli", *map(str, arguments)]


def child_environment(**changes: str) -> dict[str, str]:
    """Return the environment for a child process."""
    from sher3_runtime.environment import child_environment as make

    return make(**changes)
