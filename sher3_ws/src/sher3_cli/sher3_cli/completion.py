"""Command `completion`: shell completion without touching the user's files; the script goes to standard output."""

from __future__ import annotations

from enum import Enum

import typer

app = typer.Typer(rich_markup_mode="markdown")


class Shell(str, Enum):
    """Shells with completion."""

    bash = "bash"
    zsh = "zsh"
    fish = "fish"


@app.command(epilog="Example: `sher3 completion bash >> ~/.bashrc`")
def completion(shell: Shell) -> None:
    """Print the completion script of a shell."""
    from typer.completion import get_completion_script

    typer.echo(get_completion_script(prog_name="sher3", complete_var="_SHER3_COMPLETE", shell=shell.value))
