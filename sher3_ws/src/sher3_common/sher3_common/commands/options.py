"""Options of several commands, and how a command ends when something it was given is wrong."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

import typer

from sher3_common.errors import Sher3Error
from sher3_common.namespace import NAMESPACE_VARIABLE, use_namespace

Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of text.")]
BAD_INPUT = 2
"""Exit code where an option, a file or a value is not valid, as Typer's own."""
Domain = Annotated[int, typer.Option(min=0, max=232, help="ROS domain id of the graph.", envvar="ROS_DOMAIN_ID")]
InNamespace = Annotated[
    str,
    typer.Option(
        "--namespace", help="Namespace of the robot in the graph.", envvar=NAMESPACE_VARIABLE, callback=use_namespace
    ),
]
"""Where the robot is; the command is in that namespace as soon as its options are read."""


@contextmanager
def reported(as_json: bool) -> Iterator[None]:
    """Turn an error of the project into one sentence on stderr (an object with --json) and its exit code, mostly 2."""
    try:
        yield
    except Sher3Error as error:
        typer.echo(json.dumps(error.to_dict(), default=str) if as_json else f"sher3: {error}", err=True)
        raise typer.Exit(getattr(error, "exit_code", BAD_INPUT)) from error
