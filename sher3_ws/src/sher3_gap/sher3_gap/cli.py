"""The commands of `sher3 gap`."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from sher3_description import Sher3Error

app = typer.Typer(no_args_is_help=True, help="Find and explain the gap between a robot and its simulation.")

BAD_INPUT = 2
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of text.")]
RobotFile = Annotated[Path | None, typer.Option(help="robot.yaml of the nominal model; default: the case's.")]
VerdictFile = Annotated[Path, typer.Argument(help="verdict.json of `sher3 gap diagnose`.")]


@contextmanager
def reported(as_json: bool) -> Iterator[None]:
    """Turn an error of ours into one sentence on stderr (an object with --json) and exit code 2."""
    try:
        yield
    except Sher3Error as error:
        typer.echo(json.dumps(error.to_dict(), default=str) if as_json else f"error: {error}", err=True)
        raise typer.Exit(BAD_INPUT) from error


@app.command(epilog="Examples: sher3 gap diagnose case_001 · sher3 gap diagnose cases/* --jobs 2 --out verdicts")
def diagnose(
    case: Annotated[list[Path], typer.Argument(help="Case folder; several are diagnosed one by one.")],
    robot: RobotFile = None,
    without: Annotated[list[str] | None, typer.Option(help="Leave this effect out; repeat for more.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for verdict.json and report.html; default gap/CASE.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Cases at a time on this machine.")] = 1,
    dask: Annotated[str, typer.Option(help="Address of a Dask scheduler that diagnoses the cases.")] = "",
    report: Annotated[bool, typer.Option("--report/--no-report", help="Write the HTML report.")] = True,
    as_json: Json = False,
) -> None:
    """Say where robot and simulation part, which effect causes it and how far the gap shrinks; or abstain.

    Exit codes: 0 every case was answered, 2 a case or option is wrong (one sentence says why).
    """
    from sher3_gap.cli_diagnose import Task, as_data, check_effects, folders, run_here, run_on_dask, write_answer
    from sher3_gap.cli_print import progress, summary

    with reported(as_json):
        target, effects = folders(case, out), check_effects(without or [])
        tasks = [Task(c, robot, effects, report) for c in case]
        data: list[dict[str, Any]] = []
        with progress(len(tasks)) as (say, done):
            for found in run_on_dask(tasks, dask) if dask else run_here(tasks, jobs, say):
                files = [] if found.error else write_answer(found, target[found.task.case])
                data.append(as_data(found, files))
                done(found, "" if as_json else summary(found, files, len(tasks) > 1))
    if as_json:
        typer.echo(json.dumps({"cases": data}, default=str))
    if any("error" in entry for entry in data):
        raise typer.Exit(BAD_INPUT)


@app.command(epilog="Example: sher3 gap apply gap/case_001/verdict.json -o corrected.yaml --case case_001")
def apply(
    verdict: VerdictFile,
    output: Annotated[Path, typer.Option("--output", "-o", help="Effects file to write.")] = Path("effects.yaml"),
    case: Annotated[Path | None, typer.Option(help="Also run this case again and print the gap that is left.")] = None,
    robot: RobotFile = None,
    as_json: Json = False,
) -> None:
    """Write the effects file that puts a verdict's causes into the simulator; `sher3 up --effects` loads it."""
    from sher3_description import load_robot

    from sher3_gap.apply import apply_verdict, compare_case
    from sher3_gap.cli_print import applied_text
    from sher3_gap.loading import load_case

    with reported(as_json):
        runs, model = load_case(case, robot) if case else ([], load_robot(robot))
        effects = apply_verdict(verdict, output, model)
        stages = compare_case(runs, model, effects) if runs else []
        if as_json:
            rows = [{**s.__dict__, "closure": s.closure} for s in stages]
            typer.echo(json.dumps({"effects": str(output), "count": len(effects), "stages": rows}))
        else:
            typer.echo(applied_text(effects, stages, output))


@app.command(epilog="Example: sher3 gap compare case corrected")
def compare(
    case: Annotated[Path, typer.Argument(help="Case of the robot.")],
    other: Annotated[Path, typer.Argument(help="Case of the corrected simulator, of the same excitations.")],
    robot: RobotFile = None,
    as_json: Json = False,
) -> None:
    """Print per stage how far the robot is from the nominal simulator, and from what another case recorded."""
    from sher3_gap.apply import compare_cases
    from sher3_gap.cli_print import stages_text
    from sher3_gap.loading import load_case

    with reported(as_json):
        runs, model = load_case(case, robot)
        stages = compare_cases(runs, model, load_case(other, robot)[0])
        rows = [{**s.__dict__, "closure": s.closure} for s in stages]
        typer.echo(json.dumps({"stages": rows}) if as_json else stages_text(stages))


@app.command(epilog="Example: sher3 gap experiment gap/case_001/verdict.json case_001 -o tell_apart.yaml")
def experiment(
    verdict: VerdictFile,
    case: Annotated[
        Path | None, typer.Argument(help="Its case: actual floors and loads, excitations not again.")
    ] = None,
    output: Annotated[Path, typer.Option("--output", "-o", help="Excitation file to write.")] = Path("experiment.yaml"),
    ran: Annotated[
        Path | None, typer.Option(help="Case the written file was run to: predicted against realised.")
    ] = None,
    robot: RobotFile = None,
    as_json: Json = False,
) -> None:
    """Design the excitation that best tells a verdict's rivals apart; `sher3 gap excite FILE` runs it."""
    from sher3_gap.cli_experiment import design_command, realised_command

    with reported(as_json):
        text = (
            design_command(verdict, case, output, robot, as_json)
            if ran is None
            else realised_command(verdict, output, ran, robot, as_json)
        )
        typer.echo(text)


@app.command(epilog="Example: sher3 gap library friction")
def library(
    which: Annotated[str, typer.Argument(help="Effect id or family; all by default.")] = "",
    as_json: Json = False,
) -> None:
    """List the effects the diagnosis knows: what each is, its parameters, and what tells it from its siblings."""
    from sher3_gap.cli_print import library_data, library_text

    with reported(as_json):
        rows = library_data(which)
        typer.echo(json.dumps({"effects": rows}) if as_json else library_text(rows))


def _mount() -> None:
    """Add the commands that live in files of their own."""
    from sher3_gap.challenge.command import challenge
    from sher3_gap.cli_excite import excite_command, monitor_command
    from sher3_gap.cli_import import IMPORT_EXAMPLE, import_data

    example = "Examples: sher3 gap excite · sher3 gap excite all -o case · sher3 gap excite sweep --simulate -o case"
    app.command("excite", epilog=example)(excite_command)
    app.command("monitor", epilog="Example: sher3 gap monitor --effects effects.yaml --json")(monitor_command)
    app.command(epilog="Example: sher3 gap challenge --seeds 0:40 --json")(challenge)
    app.command("import", epilog=f"Example: {IMPORT_EXAMPLE}")(import_data)


_mount()
