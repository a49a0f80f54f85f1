"""Options of several commands, and how a command ends when something it was given is wrong."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

import typer

from sher3_common.errors import Sher3Error

Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of text.")]
Domain = Annotated[int, typer.Option(min=0, max=232, help="ROS domain id of the graph.", envvar="ROS_DOMAIN_ID")]


@contextmanager
def reported(as_json: bool, code: int = 1) -> Iterator[None]:
    """Turn an error of the project into one sentence on stderr (an object with --json) and an exit code."""
    try:
        yield
    except Sher3Error as error:
        typer.echo(json.dumps(error.to_dict(), default=str) if as_json else f"error: {error}", err=True)
        raise typer.Exit(code) from error
