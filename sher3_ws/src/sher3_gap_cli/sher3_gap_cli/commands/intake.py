"""`sher3 gap import`, `case` and `describe`: records become a case that `sher3 gap diagnose` answers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from sher3_common.commands.options import Json

from sher3_gap_cli.options import RobotFile, check_writable, echo_result, reported, written

IMPORT_EXAMPLE = "sher3 gap import DATA_EMPS.mat emps.yaml --out cases/emps"


def import_data(
    paths: Annotated[
        list[Path],
        typer.Argument(help="Data files (csv, mat, npz, json, bags) or folders, one a run; then the description."),
    ],
    out: Annotated[Path, typer.Option(help="Case folder to write.")],
    as_json: Json = False,
) -> None:
    """Turn records of another machine and a short YAML description of it into a case.

    Descriptions of known data sets are named without a path: emps, rhoban_mx_drop, sage_so101,
    dfki_simple_pendulum, dfki_double_pendulum, franka_fr3_calib, kuka_kr300, davinci_tool, tiago_dynamics. Exit
    codes: 0 written, 2 data or description are wrong (one sentence says why).
    """
    from sher3_machines import MachineError
    from sher3_machines.intake.case import RUNS, described, import_case

    with reported(as_json):
        if len(paths) < 2:
            raise MachineError("data and a description are needed", value=len(paths), remedy=IMPORT_EXAMPLE)
        check_writable(folders=[out])
        notes = import_case(paths[:-1], described(paths[-1]), out)
        number = len(list((out / RUNS).glob("*.npz")))
        text = "\n".join([f"{out}: {number} run{'s' * (number > 1)}", *notes])
        echo_result(as_json, {"case": str(out), "runs": number, "notes": notes}, text)


def describe(
    file: Annotated[Path, typer.Argument(help="Data file, folder of files, or bag.")],
    out: Annotated[Path | None, typer.Option(help="YAML file to write; default: print it.")] = None,
    rate: Annotated[float | None, typer.Option(min=1e-3, help="Samples per second, without a time.")] = None,
    model: Annotated[Path | None, typer.Option(help="URDF or MJCF of the arm whose joints were recorded.")] = None,
    names: Annotated[str, typer.Option(help="Names of the columns in order, parted by commas.")] = "",
    as_json: Json = False,
) -> None:
    """Draft a machine description from a file and say what was guessed; check it before you import with it.

    Exit codes: 0 drafted, 2 the file cannot be read or nothing in it looks like a position.
    """
    from sher3_machines.drafting.drafts import draft_of

    with reported(as_json):
        check_writable([out])
        found = draft_of(file, rate, model, [name.strip() for name in names.split(",")] if names else ())
        if out is not None:
            written(out, found.text)
        guessed = "\n".join([str(out), *(f"  guessed: {guess}" for guess in found.guesses)])
        text = found.text.removesuffix("\n") if out is None else guessed
        echo_result(as_json, {"description": found.text, "guesses": found.guesses}, text)


def case(
    bags: Annotated[list[Path], typer.Argument(help="Recordings of the SHER, one a run.")],
    out: Annotated[Path, typer.Option(help="New case folder to write.")],
    robot: RobotFile = None,
    as_json: Json = False,
) -> None:
    """Make a case of recordings of the SHER; runs of one excitation become repeats of it.

    Exit codes: 0 written, 2 a bag cannot be read, or the folder exists.
    """
    from sher3_gap.case.assembling import assemble

    with reported(as_json):
        check_writable(folders=[out])
        runs = assemble(bags, out, robot)
        data = [{"excitation": run.excitation, "repeat": run.repeat, "bag": str(run.bag)} for run in runs]
        lines = [f"  {x['excitation']} {x['repeat']}: {x['bag']}" for x in data]
        echo_result(as_json, {"case": str(out), "runs": data}, "\n".join([f"{out}", *lines]))
