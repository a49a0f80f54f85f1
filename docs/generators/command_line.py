"""The `sher3` command as a tree of commands.

The commands are Click's, or those of the copy of Click that newer releases of Typer carry: hence `Any`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import typer
from sher3_cli.root import make_app
from typer.testing import CliRunner


def application() -> typer.Typer:
    """Return the whole command line, every command imported."""
    return make_app("*")


def commands() -> Iterator[tuple[str, Any]]:
    """Yield every command that does something, with its full name as it is typed."""
    yield from _walk("sher3", typer.main.get_command(application()))


def run_json(*arguments: str) -> dict:
    """Return what a command prints with `--json`."""
    result = CliRunner().invoke(application(), list(arguments), catch_exceptions=False)
    return json.loads(result.stdout)


def _walk(name: str, command: Any) -> Iterator[tuple[str, Any]]:
    children = getattr(command, "commands", None)
    if children is None or getattr(command, "invoke_without_command", False):
        yield name, command
    for child, below in sorted((children or {}).items()):
        yield from _walk(f"{name} {child}", below)
