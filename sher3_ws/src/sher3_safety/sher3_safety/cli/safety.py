"""Command `safety`: the matrix of faults, measured."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Optional

import typer
from sher3_common.commands.options import Json

from sher3_safety.cli.budget import budget
from sher3_safety.cli.hazards import hazards
from sher3_safety.cli.search import search

app = typer.Typer(rich_markup_mode="markdown", invoke_without_command=True)

app.command(epilog="Examples: `sher3 safety budget` · `sher3 safety budget --rate 200 --json`")(budget)
app.command(epilog="Examples: `sher3 safety hazards` · `sher3 safety hazards --json`")(hazards)
app.command(epilog="Examples: `sher3 safety search` · `sher3 safety search --trials 20000 --kept drawn`")(search)


@app.callback(
    epilog="Examples: `sher3 safety --only pedal` · `sher3 safety --wall` · "
    "`sher3 safety --only healthy --healthy 600 --kept hours`"
)
def safety(
    context: typer.Context,
    out: Annotated[Path, typer.Option(help="Folder for report.md, report.json and the bags.")] = Path("bags/safety"),
    only: Annotated[str, typer.Option(help="Only components whose name begins so; `healthy`: none.")] = "",
    quick: Annotated[bool, typer.Option("--quick", help="The compact set of the default test run.")] = False,
    composed: Annotated[
        bool, typer.Option("--composed", help="The loop in one process, as in `sher3 up`; stepped time only.")
    ] = False,
    wall: Annotated[bool, typer.Option("--wall", help="Kill and hold processes in wall time instead.")] = False,
    healthy: Annotated[
        Optional[float],  # noqa: UP045
        typer.Option(help="Minutes of healthy running to count false trips in; 5 with the whole matrix.", min=0.0),
    ] = None,
    kept: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="Folder to keep healthy sessions in; a run that was ended goes on there.", file_okay=False),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of noise and faults.", min=0)] = 1,
    jobs: Annotated[int, typer.Option(help="Processes at a time (stepped time only).", min=1, max=16)] = 1,
    as_json: Json = False,
) -> None:
    """Break everything in turn and measure, from recordings, how soon the robot stops and how far its tip travels.

    Every component with every fault, at rest, at the speed near tissue, and at the speed limit, in stepped time; with
    `--wall` processes are killed and held in real time. Exit code 1 when a cell misses.
    """
    if context.invoked_subcommand is not None:
        return
    from sher3_safety.runs.matrix import COMMAND, MatrixResult, run_matrix
    from sher3_safety.runs.wall import run_wall

    run: Any = run_wall if wall else partial(run_matrix, composed=composed)
    none = only == "healthy"
    command = f"{COMMAND} --only healthy"
    result = (
        MatrixResult((), command, seed) if none else run(out, only=only, quick=quick, seed=seed, jobs=jobs, say=_say)
    )
    minutes = healthy if healthy is not None else 0.0 if (only and not none) or quick or wall else 5.0
    if minutes:
        from sher3_safety.runs.healthy import run_healthy

        result.false_trips = run_healthy(out, minutes, seed, jobs, _say, kept)
    result.write(out)
    typer.echo(json.dumps(result.to_dict()) if as_json else result.as_text())
    if result.missed:
        raise typer.Exit(1)


def _say(text: str) -> None:
    typer.echo(text, err=True)
