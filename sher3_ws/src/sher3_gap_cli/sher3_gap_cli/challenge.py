"""`sher3 gap challenge`: sealed cases, scores, and the same for the baselines."""

from __future__ import annotations

import json
import re
import tempfile
from pathlib import Path
from typing import Annotated

import typer

from sher3_gap_cli.options import Json, reported


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
        raise ChallengeError("gap over floor is not a range", value=text, limit="0 < A < B <= 100, as in 0.5:30")
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
