"""`sher3 gap compare-simulators`: where two simulators differ that were given the same commands."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from sher3_common.commands.options import Json

from sher3_gap_cli.options import echo_result, reported

if TYPE_CHECKING:
    from sher3_public.simulators.comparing import Comparison


def compare_simulators(
    first: Annotated[Path, typer.Argument(help="Trace of the reference: CSV, npz or any other table.")],
    second: Annotated[Path, typer.Argument(help="Trace of the other one, on the same stamps.")],
    model: Annotated[Path | None, typer.Option(help="URDF or MJCF of the robot.")] = None,
    as_json: Json = False,
) -> None:
    """Say where two simulators, or two versions of one, part that were told the same, and by which setting or effect.

    Exit codes: 0 compared, 2 a trace or the model is wrong, or the commands were not the same.
    """
    from sher3_machines.intake.tables import read_tables
    from sher3_public.simulators.comparing import compare_simulators as compared

    with reported(as_json):
        found = compared(read_tables(first), read_tables(second), model, (first.stem, second.stem))
        echo_result(as_json, data(found), str(found))


def data(found: Comparison) -> dict[str, Any]:
    """Return a comparison as plain data."""
    verdict = None if found.answer is None else found.answer.verdict.model_dump(by_alias=True, mode="json")
    settings = dict(zip(found.names, found.settings, strict=True))
    return {"apart": found.apart.tolist(), "cause": found.cause, "settings": settings, "verdict": verdict}
