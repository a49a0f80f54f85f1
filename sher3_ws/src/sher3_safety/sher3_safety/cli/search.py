"""Command `safety search`: pairs and triples of faults, drawn, and climbed towards those that move the tip furthest."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Optional

import typer
from sher3_common.commands.options import Json


def search(
    trials: Annotated[int, typer.Option(help="Number of draws, with those kept.", min=1)] = 200,
    seed: Annotated[int, typer.Option(help="Seed of the draws.", min=0)] = 1,
    kept: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="Folder to keep the trials in; a search that was ended goes on there.", file_okay=False),
    ] = None,
    draw: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(help="Try this line of the table again, `regime, state, faults`, instead of drawing."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Draw two or three faults at a time, in stepped time, and look on near those that move the tip furthest.

    Kind, size, axis, onset to the tick, state and regime are drawn. Prints the worst ten; exit code 1 when one is
    beyond the budget of an axis that goes by itself, 40 um near tissue and 250 um free.
    """
    from sher3_safety.search.climb import again
    from sher3_safety.search.climb import search as run
    from sher3_safety.search.words import read

    def say(text: str) -> None:
        typer.echo(text, err=True)

    result = again([read(line) for line in draw], seed) if draw else run(trials, seed, say=say, kept=kept)
    typer.echo(json.dumps(result.to_dict()) if as_json else result.as_text())
    if result.missed:
        raise typer.Exit(1)
