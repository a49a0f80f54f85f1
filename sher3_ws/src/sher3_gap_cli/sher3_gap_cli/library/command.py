"""`sher3 gap library`: the effects the diagnosis knows, or the page of one."""

from __future__ import annotations

from typing import Annotated

import typer
from sher3_common.commands.options import Json

from sher3_gap_cli.options import Library, Trust, echo_result, effects, reported


def library(
    which: Annotated[
        str, typer.Argument(help="Effect id or family; all by default.", autocompletion=effects(families=True))
    ] = "",
    own: Library = None,
    trust: Trust = False,
    as_json: Json = False,
) -> None:
    """List the effects the diagnosis knows, or print the whole page of one."""
    from sher3_effects import add_library

    from sher3_gap_cli.library.page import library_data, list_text, page_text

    with reported(as_json):
        add_library(own or [], trust)
        rows = library_data(which)
        echo_result(as_json, {"effects": rows}, page_text(rows[0]) if len(rows) == 1 else list_text(rows))
