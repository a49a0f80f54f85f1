"""Command `safety budget`: how far the tip may travel after each fault, from the settings alone."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Optional

import typer


def budget(
    rate: Annotated[float, typer.Option(help="Control rate [Hz].", min=100.0, max=1000.0)] = 500.0,
    robot: Annotated[Optional[Path], typer.Option(help="Robot file; the nominal robot by default.")] = None,  # noqa: UP045
    patient: Annotated[bool, typer.Option("--patient", help="The time limits of the demo on mocks.")] = False,
    near_speed: Annotated[Optional[float], typer.Option(help="Speed cap near tissue [m/s].")] = None,  # noqa: UP045
    free_speed: Annotated[Optional[float], typer.Option(help="Speed cap elsewhere [m/s].")] = None,  # noqa: UP045
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of text.")] = False,
) -> None:
    """Print, per regime and fault, how soon it is noticed, how soon the robot stands, and how far the tip travels.

    Exit code 1 when a fault exceeds the budget of its regime: such settings are refused by `sher3 up`.
    """
    from sher3_bringup.settings.run_settings import RunSettings
    from sher3_faults.budget import GUARDED

    patience = "patient" if patient else "strict"
    settings = RunSettings.model_validate(
        {
            "rate": rate,
            "robot_path": robot,
            "patience": patience,
            "near_speed": near_speed,
            "free_speed": free_speed,
            "regime": "free",
        }
    )
    found = settings.budget()
    typer.echo(json.dumps(found.to_dict()) if as_json else found.as_text())
    if any(row.travel > row.budget for regime in GUARDED for row in found.of(regime)):
        raise typer.Exit(1)
