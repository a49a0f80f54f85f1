"""`sher3 gap import`: data of another machine and its description become a case that `sher3 gap diagnose` answers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from sher3_gap_cli.options import Json, reported

IMPORT_EXAMPLE = "sher3 gap import DATA_EMPS.mat emps.yaml --out cases/emps"


def import_data(
    paths: Annotated[
        list[Path],
        typer.Argument(help="Data files (csv, mat, npz, json) or folders, one a run; then the description."),
    ],
    out: Annotated[Path, typer.Option(help="Case folder to write.")],
    as_json: Json = False,
) -> None:
    """Turn records of another machine and a short YAML description of it into a case.

    Descriptions of known data sets are named without a path: emps, rhoban_mx_drop, sage_so101, dfki_simple_pendulum,
    franka_fr3_calib. Exit codes: 0 written, 2 data or description are wrong (one sentence says why).
    """
    from sher3_machines import MachineError
    from sher3_machines.intake.case import described, import_case

    with reported(as_json):
        if len(paths) < 2:
            raise MachineError("data and a description are needed", value=len(paths), remedy=IMPORT_EXAMPLE)
        notes = import_case(paths[:-1], described(paths[-1]), out)
        if as_json:
            typer.echo(json.dumps({"case": str(out), "runs": len(paths) - 1, "notes": notes}))
        else:
            typer.echo("\n".join([f"{out}: {len(paths) - 1} run{'s' * (len(paths) > 2)}", *notes]))
