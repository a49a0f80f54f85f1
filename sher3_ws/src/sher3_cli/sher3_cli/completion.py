"""Command `completion`: shell completion without touching the user's files; the script goes to standard output."""

from __future__ import annotations

import os
from enum import Enum
from typing import Annotated

import typer

COMPLETE = "_SHER3_COMPLETE"
"""Variable by which a shell's script asks what to offer."""

app = typer.Typer(rich_markup_mode="markdown")


class Shell(str, Enum):
    """Shells with completion."""

    bash = "bash"
    zsh = "zsh"
    fish = "fish"


@app.command(epilog="Example: `sher3 completion bash >> ~/.bashrc`")
def completion(shell: Annotated[Shell, typer.Argument(help="Whose script: bash, zsh or fish.")]) -> None:
    """Print the completion script of a shell."""
    from typer.completion import get_completion_script

    typer.echo(get_completion_script(prog_name="sher3", complete_var=COMPLETE, shell=shell.value))


def completed_words() -> list[str] | None:
    """Return the words after `sher3` that a shell wants completed; None when no shell asks."""
    if COMPLETE not in os.environ:
        return None
    return (os.environ.get("COMP_WORDS") or os.environ.get("_TYPER_COMPLETE_ARGS", "")).split()[1:]
