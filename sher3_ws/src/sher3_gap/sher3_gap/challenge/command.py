"""The command `sher3 gap challenge`: sealed cases, scores, and the same for the baselines."""

from __future__ import annotations

import json
import re
import tempfile
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from .plan import ChallengeError
from .run import Outcome, requests, run_challenge
from .score import Rate, Summary

TARGETS = {
    "false_alarm": ("<=", 0.02),
    "stage": (">=", 0.95),
    "actuator": (">=", 0.97),
    "family": (">=", 0.92),
    "in_set": (">=", 0.95),
    "set_size": ("<=", 1.5),
    "top1": (">=", 0.85),
    "outside_abstention": (">=", 0.85),
    "outside_false_attribution": ("<=", 0.05),
    "closure_within_0.05": (">=", 0.90),
}
"""What the diagnosis is held to on cases with a gap of at least three floors."""


def parse_seeds(text: str) -> tuple[int, int]:
    """Return first seed and the one after the last of `A:B`; raises ChallengeError."""
    match = re.fullmatch(r"(\d+):(\d+)", text)
    if match is None:
        raise ChallengeError("seeds are not a range", value=text, limit="A:B", remedy="as in 0:100")
    return int(match.group(1)), int(match.group(2))


def parse_gap(text: str) -> tuple[float, float]:
    """Return the two ends of a range of gap over floor; raises ChallengeError."""
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
    jobs: Annotated[int, typer.Option(min=1, help="Processes.")] = 2,
    without: Annotated[str | None, typer.Option(help="Leave this effect out; every case has it.")] = None,
    out: Annotated[Path | None, typer.Option(help="New folder that keeps cases, labels, verdicts and scores.")] = None,
    baselines: Annotated[bool, typer.Option(help="Score four baselines on the same residuals.")] = True,
    as_json: Annotated[bool, typer.Option("--json", help="Print the scores as JSON.")] = False,
) -> None:
    """Build sealed cases from the truth plant, diagnose them blind and score the verdicts."""
    wanted = requests(parse_seeds(seeds), [k for k in kinds.split(",") if k], without, parse_gap(gap))
    console = Console(stderr=True)
    with tempfile.TemporaryDirectory() as scratch:
        folder = out or Path(scratch) / "challenge"
        outcome = run_challenge(folder, wanted, jobs=jobs, baselines=baselines, say=console.log)
    if as_json:
        typer.echo(json.dumps(outcome.as_dict()))
        return
    print_outcome(outcome, Console())
    if out is not None:
        console.log(f"kept in {out}")


def print_outcome(outcome: Outcome, console: Console) -> None:
    """Print the tables of an outcome."""
    first, last = outcome.seeds
    summaries = {who: outcome.summary(who, least=3.0) for who in outcome.scores}
    console.print(rates_table(f"gap/floor of at least 3, seeds {first}:{last}", summaries))
    whole = outcome.summary()
    console.print(rates_table("all cases", {who: outcome.summary(who) for who in outcome.scores}))
    console.print(confusion_table("status (truth down, verdict across)", whole.status_confusion))
    console.print(confusion_table("family of single faults (truth down, verdict across)", whole.family_confusion))
    console.print(detectability_table(whole))
    console.print(f"{len(outcome.scores['diagnosis'])} cases in {outcome.seconds:.0f} s")


def rates_table(title: str, summaries: dict[str, Summary]) -> Table:
    """Return the table of rates, one column per competitor, with the targets."""
    table = Table("rate", "target", *summaries, title=title)
    first = next(iter(summaries.values()))
    for name in first.rates:
        sign, limit = TARGETS.get(name, ("", 0.0))
        target = f"{sign} {limit:g}" if sign else ""
        table.add_row(name, target, *(_cell(summary.rates[name]) for summary in summaries.values()))
    return table


def _cell(rate: Rate) -> str:
    if rate.value is None:
        return "-"
    interval = f" [{rate.low:.2f}, {rate.high:.2f}]" if rate.low is not None else ""
    return f"{rate.value:.3f}{interval} n={rate.n}"


def confusion_table(title: str, confusion: dict[str, dict[str, int]]) -> Table:
    """Return a confusion table."""
    columns = sorted({said for row in confusion.values() for said in row})
    table = Table("", *columns, title=title)
    for true, row in confusion.items():
        table.add_row(true, *(str(row.get(said, 0)) for said in columns))
    return table


def detectability_table(summary: Summary) -> Table:
    """Return the detectability of single faults by gap over floor."""
    table = Table("gap/floor", "n", "detected", "family", "top1", "in_set", title="detectability of single faults")
    for row in summary.detectability:
        shares = (row[key] for key in ("detected", "family", "top1", "in_set"))
        table.add_row(str(row["gap_over_floor"]), str(row["n"]), *(f"{share:.2f}" for share in shares))
    return table
