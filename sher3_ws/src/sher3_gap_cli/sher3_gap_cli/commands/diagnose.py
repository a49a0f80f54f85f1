"""`sher3 gap diagnose`: the answer on one or many cases, on this machine or on a cluster."""

from __future__ import annotations

import gc
import json
from pathlib import Path
from typing import Annotated, Any

import typer
from sher3_common.commands.options import Json

from sher3_gap_cli.options import BAD_INPUT, Library, RobotFile, Trust, case_argument, check_writable, effects, reported

OBJECTS = 50_000
"""New objects after which Python looks for cycles: at its 700 that takes 6 % of a diagnosis."""


def diagnose(
    case: Annotated[list[Path], case_argument("Case folder; several are diagnosed one by one.")],
    robot: RobotFile = None,
    without: Annotated[
        list[str] | None, typer.Option(help="Leave this effect out; repeat for more.", autocompletion=effects())
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for verdict.json and report.html; default gap/CASE.")] = None,
    own: Library = None,
    trust: Trust = False,
    jobs: Annotated[int, typer.Option(min=1, help="Cases at a time on this machine.")] = 1,
    dask: Annotated[str, typer.Option(help="Address of a Dask scheduler that diagnoses the cases.")] = "",
    costs: Annotated[
        str, typer.Option(help="What mistakes cost: name (a wrong cause), abstain (needlessly), miss (a gap).")
    ] = "name=1,abstain=1,miss=1",
    report: Annotated[bool, typer.Option("--report/--no-report", help="Write the HTML report.")] = True,
    as_json: Json = False,
) -> None:
    """Say where robot and simulation part, which effect causes it and how far the gap shrinks; or abstain.

    Exit codes: 0 every case was answered, 2 a case or option is wrong (one sentence says why).
    """
    gc.set_threshold(OBJECTS)
    from sher3_diagnosis.judge.costs import Costs
    from sher3_effects import add_library

    from sher3_gap_cli.answers import Task, answer, as_data, check_effects, folders, write_answer
    from sher3_gap_cli.printing import progress, summary
    from sher3_gap_cli.workers import run_here, run_on_dask

    with reported(as_json):
        add_library(own or [], trust)
        target, left_out = folders(case, out), check_effects(without or [])
        check_writable(folders=list(target.values()))
        mistakes = Costs.parse(costs)
        tasks = [Task(c, robot, left_out, report, str(target[c]), mistakes) for c in case]
        data: list[dict[str, Any]] = []
        with progress(len(tasks)) as (say, done):
            for found in run_on_dask(answer, tasks, dask) if dask else run_here(answer, tasks, jobs, say):
                files = [] if found.error else write_answer(found, target[found.task.case])
                data.append(as_data(found, files))
                done(found, "" if as_json else summary(found, files, len(tasks) > 1))
    if as_json:
        typer.echo(json.dumps({"cases": data}, default=str))
    if any("error" in entry for entry in data):
        raise typer.Exit(BAD_INPUT)
