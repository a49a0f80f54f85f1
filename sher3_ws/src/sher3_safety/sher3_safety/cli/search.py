"""Command `safety search`: pairs and triples of faults, drawn, and climbed towards those that move the tip furthest."""

from __future__ import annotations

import json
from typing import Annotated

import typer
from sher3_common.commands.options import Json


def search(
    trials: Annotated[int, typer.Option(help="Number of draws.", min=1)] = 200,
    seed: Annotated[int, typer.Option(help="Seed of the draws.", min=0)] = 1,
    as_json: Json = False,
) -> None:
    """Draw two or three faults at a time, in stepped time, and look on near those that move the tip furthest.

    Kind, size, axis, onset to the tick, state and regime are drawn. Prints the worst ten; exit code 1 when one is
    beyond the budget of an axis that goes by itself, 40 um near tissue and 250 um free.
    """
    from sher3_safety.search.climb import search as run

    result = run(trials, seed, say=lambda text: typer.echo(text, err=True))
    typer.echo(json.dumps(result.to_dict()) if as_json else result.as_text())
    if result.missed:
        raise typer.Exit(1)
