"""Shell completion without touching the user's files: the script goes to standard output."""

from __future__ import annotations

from enum import Enum


class Shell(str, Enum):
    """Shells with completion."""

    bash = "bash"
    zsh = "zsh"
    fish = "fish"


def completion_script(shell: Shell) -> str:
    """Return the completion script of `sher3` for a shell."""
    from typer.completion import get_completion_script

    return get_completion_script(prog_name="sher3", complete_var="_SHER3_COMPLETE", shell=shell.value)
