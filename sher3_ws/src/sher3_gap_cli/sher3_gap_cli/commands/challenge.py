"""`sher3 gap challenge`: sealed cases and their scores; `sher3 gap calibrate`: what labelled cases teach."""

from __future__ import annotations

import json
import math
import re
import tempfile
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Annotated

import typer
from sher3_common.commands.options import Json

from sher3_gap_cli.options import check_writable, echo_result, reported


def parse_seeds(text: str) -> tuple[int, int]:
    """Return first seed and the one after the last of `A:B`; raises ChallengeError."""
    from sher3_challenge.errors import ChallengeError

    match = re.fullmatch(r"(\d+):(\d+)", text)
    if match is None:
        raise ChallengeError("seeds are not a range", value=text, limit="A:B", remedy="as in 0:100")
    return int(match.group(1)), int(match.group(2))


def parse_gap(text: str) -> tuple[float, float]:
    """Return the two ends of a range of gap over floor; raises ChallengeError."""
    from sher3_challenge.errors import ChallengeError

    match = re.fullmatch(r"(\d+(?:\.\d+)?):(\d+(?:\.\d+)?)", text)
    if match is None or not 0 < float(match.group(1)) < float(match.group(2)) <= 100:
        raise ChallengeError(
            "gap over floor is not a range",
            value=text,
            limit="0 < A < B <= 100, as in 0.5:30",
            remedy="write the smaller number first",
        )
    return float(match.group(1)), float(match.group(2))


def challenge(
    seeds: Annotated[str, typer.Option(help="Range A:B of seeds, one case each.")] = "0:40",
    kinds: Annotated[
        str, typer.Option(help="Kinds dealt in turn: healthy,single,compound,outside,under_excited,withheld.")
    ] = "",
    gap: Annotated[str, typer.Option(help="Range of gap over floor of single faults, log-uniform.")] = "0.5:30",
    plant: Annotated[
        list[str] | None, typer.Option(help="Truth plant; repeat to deal several in turn. All of them where not given.")
    ] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Processes.")] = 2,
    without: Annotated[str | None, typer.Option(help="Leave this effect out; every case has it.")] = None,
    out: Annotated[Path | None, typer.Option(help="New folder that keeps cases, labels, verdicts and scores.")] = None,
    baselines: Annotated[bool, typer.Option(help="Score four baselines on the same residuals.")] = True,
    merge: Annotated[
        list[Path] | None, typer.Option(help="Build nothing: tables over finished folders; repeat for each.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Build sealed cases from truth plants, diagnose them blind and score the verdicts."""
    from rich.console import Console
    from sher3_challenge.run import requests, run_challenge
    from sher3_challenge.score.outcome import merged
    from sher3_challenge.score.tables import print_outcome

    console = Console(stderr=True, markup=False)
    with reported(as_json), tempfile.TemporaryDirectory() as scratch:
        if merge:
            outcome = merged(merge)
        else:
            check_writable(folders=[out])
            chosen = [k for k in kinds.split(",") if k]
            wanted = requests(parse_seeds(seeds), chosen, without, parse_gap(gap), plant or (), console.log)
            folder = out or Path(scratch) / "challenge"
            outcome = run_challenge(folder, wanted, jobs=jobs, baselines=baselines, say=console.log)
    if as_json:
        typer.echo(json.dumps(outcome.as_dict()))
        return
    print_outcome(outcome, Console())
    if out is not None and not merge:
        console.log(f"kept in {out}")


def plants_of(arguments: list[str]) -> dict[str, list[Path]]:
    """Return plant -> its labelled cases, of arguments NAME=FOLDER or FOLDER; raises ChallengeError.

    Without a name each case is of the plant its label names; where it names none, the folder does.
    """
    from sher3_challenge.calibration.observe import labelled, plant_of
    from sher3_challenge.errors import ChallengeError

    out: dict[str, list[Path]] = {}
    for argument in arguments:
        name, _, folder = argument.rpartition("=")
        found = list(labelled(Path(folder)))
        if not found:
            raise ChallengeError("no labelled case", value=folder, remedy="a folder of cases with truth.yaml")
        for case in found:
            out.setdefault(name or plant_of(case) or Path(folder).name, []).append(case)
    return out


def calibrate(
    folders: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[PLANT=]FOLDER...",
            help="Folders of labelled cases; PLANT= where labels do not say which plant made them.",
        ),
    ] = None,
    drawn: Annotated[
        list[str] | None,
        typer.Option(help="Range A:B of seeds of cases drawn on the plants in turn, without bags; repeat to add up."),
    ] = None,
    minutes: Annotated[
        float,
        typer.Option(min=0.0, help="Begin no drawn case later than this: the tables are of those kept; 0 draws none."),
    ] = math.inf,
    plant: Annotated[
        list[str] | None, typer.Option(help="Truth plant of drawn cases; repeat to deal several. All where not given.")
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="File for the calibration.")] = None,
    kept: Annotated[
        Path | None, typer.Option(help="Folder that keeps the evidence of every case from one call to the next.")
    ] = None,
    diagram: Annotated[Path | None, typer.Option(help="Picture of the reliability on plants left out.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Processes.")] = 1,
    in_force: Annotated[
        bool,
        typer.Option("--in-force", help="Set no weight: judge by those in force, as verdicts are judged."),
    ] = False,
    update: Annotated[
        bool,
        typer.Option("--update", help="Start from the weights in force; move them no further than the cases ask for."),
    ] = False,
    as_json: Json = False,
) -> None:
    """Set the probabilities of verdicts on labelled cases; print how they hold on each plant when it is left out."""
    from rich.console import Console
    from sher3_challenge.calibration.drawn import draw
    from sher3_challenge.calibration.fit import calibrated, placed_among, updated
    from sher3_challenge.calibration.held_out import GROUPS, by_plant, groups, held_out, judged_by
    from sher3_challenge.calibration.observe import gathered
    from sher3_challenge.calibration.selective import curve
    from sher3_challenge.calibration.table import rates, written
    from sher3_challenge.plants.registry import truth_plants
    from sher3_challenge.score.reliability import diagram as panels
    from sher3_diagnosis.judge.calibration import calibration

    with reported(as_json), tempfile.TemporaryDirectory() as scratch:
        check_writable([out, diagram], [kept])
        room = kept or Path(scratch)
        seen = gathered(plants_of(folders or []), room, jobs)
        if drawn:
            names = plant or [known.name for known in truth_plants(Console(stderr=True).log)]
            seeds = dict.fromkeys(seed for text in drawn for seed in range(*parse_seeds(text)))
            dealt = list(draw(names, seeds, room, 60.0 * minutes))
            Console(stderr=True).log(f"evidence of {len(dealt)} of {len(seeds)} drawn cases")
            seen += chain.from_iterable(dealt)
        if in_force:
            rules = calibration.in_force()
            found = placed_among(rules, seen)
            judged = [{n: judged_by(rules, own) for n, own in groups(seen, of).items()} for of in GROUPS]
        else:
            fitted = partial(updated, calibration.in_force()) if update else calibrated
            found = fitted(seen)
            judged = [held_out(seen, of, fitted) for of in GROUPS]
        left_out = judged[GROUPS.index(by_plant)]
        columns = {name: rates(judgements) for group in judged for name, judgements in group.items()}
        if len(left_out) > 1:
            columns["all"] = rates([j for judgements in left_out.values() for j in judgements])
        if out is not None:
            out.write_text(found.model_dump_json(by_alias=True, indent=1) + "\n", encoding="utf-8")
        if diagram is not None and left_out:
            panels({name: [r for j in js for r in j.right] for name, js in left_out.items()}, diagram)
    if as_json:
        typer.echo(json.dumps({n: {k: r.__dict__ for k, r in c.items()} for n, c in columns.items()}))
        return
    typer.echo(written(columns) if columns else "one plant: nothing is left out to show the calibration on")
    if left_out:
        typer.echo("\n" + curve([c for judgements in left_out.values() for j in judgements for c in j.causes]))
    if out is not None:
        Console(stderr=True).log(f"calibration of {len(seen)} diagnoses in {out}")


def arms(
    seeds: Annotated[str, typer.Option(help="Range A:B of seeds, one case each.")] = "0:20",
    robots: Annotated[str, typer.Option(help="Arms in turn: own, panda, ur5, ur10, kinova, xarm7, z1, so101.")] = "own",
    kinds: Annotated[str | None, typer.Option(help="Kinds of fault in turn; default all.")] = None,
    seconds: Annotated[float, typer.Option(min=10.0, help="Length of a record, s.")] = 60.0,
    sysid: Annotated[
        bool, typer.Option("--sysid", help="Let mujoco.sysid answer the same cases (extra `sysid`).")
    ] = False,
    out: Annotated[Path | None, typer.Option(help="New folder that keeps cases, labels and verdicts.")] = None,
    as_json: Json = False,
) -> None:
    """Simulate arms with faults in MuJoCo, diagnose their records blind and score the verdicts.

    All arms but `own` need the extra `arms`. Exit codes: 0 scored, 2 an arm or an extra is missing.
    """
    from rich.console import Console
    from sher3_arms.run import run_arms
    from sher3_arms.score import shares, table
    from sher3_arms.truth.faults import ORDER

    console = Console(stderr=True)
    with reported(as_json), tempfile.TemporaryDirectory() as scratch:
        names = [name for name in robots.split(",") if name]
        dealt = tuple(kinds.split(",")) if kinds else ORDER
        folder = out or Path(scratch) / "arms"
        found = run_arms(range(*parse_seeds(seeds)), names, folder, seconds, console.log, sysid, dealt)
        data = {"scores": {name: {"share": x, "cases": n} for name, (x, n) in shares(found).items()}}
        cases = [case.as_dict() for case in found]
        echo_result(as_json, {**data, "cases": cases}, table(found))
