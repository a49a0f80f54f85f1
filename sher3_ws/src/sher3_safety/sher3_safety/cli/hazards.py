"""Command `safety hazards`: each hazard with its control, its verification and what is left."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Optional

import typer


def hazards(
    report: Annotated[Optional[Path], typer.Option(help="report.json of `sher3 safety`, for measured travel.")] = None,  # noqa: UP045
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of text.")] = False,
) -> None:
    """Print the hazards of the robot: cause, control, what verifies it, and how far the tip may still travel."""
    from sher3_bringup.settings.run_settings import RunSettings
    from sher3_common import read_json

    from sher3_safety.hazards import hazard_table

    cells = [] if report is None else read_json(report, MAX_REPORT_BYTES)["cells"]
    table = hazard_table(RunSettings.model_validate({"regime": "free"}).budget(), cells)
    if as_json:
        typer.echo(json.dumps({"hazards": table}))
        return
    for row in table:
        left = row["residual"]
        travel = f"{left['near_tissue']:.0f} um near tissue, {left['free']:.0f} um free" if left else "not computed"
        typer.echo(f"{row['hazard']}\n  cause     {row['cause']}\n  control   {row['control']}")
        typer.echo(f"  verified  {row['rows']} rows of the matrix; {', '.join(row['tests']) or 'no other test'}")
        typer.echo(f"  residual  {travel}")
        for state, way in row["measured"].items():
            typer.echo(f"  measured  {way:.1f} um {state}")
        if row["gap"]:
            typer.echo(f"  gap       {row['gap']}")


MAX_REPORT_BYTES = 32_000_000
"""Largest report that is read: 1000 cells take 0.6 MB."""
