"""Tables of a challenge for the terminal, with the targets beside the rates."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from sher3_challenge.score.outcome import CLEAR, Outcome
from sher3_challenge.score.rates import Rate, Summary

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
    "calibration_error": ("<=", 0.05),
}
"""What the diagnosis is held to on cases with a gap of at least three floors."""


def print_outcome(outcome: Outcome, console: Console) -> None:
    """Print the tables of an outcome."""
    first, last = outcome.seeds
    summaries = {who: outcome.summary(who, least=CLEAR) for who in outcome.scores}
    console.print(rates_table(f"gap/floor of at least {CLEAR:g}, seeds {first}:{last}", summaries))
    if len(outcome.plants) > 1:
        title = f"diagnosis by truth plant, gap/floor of at least {CLEAR:g}"
        console.print(plants_table(title, {p: outcome.summary(least=CLEAR, plant=p) for p in outcome.plants}))
    whole = outcome.summary()
    console.print(rates_table("all cases", {who: outcome.summary(who) for who in outcome.scores}))
    console.print(confusion_table("status (truth down, verdict across)", whole.status_confusion))
    console.print(confusion_table("family of single faults (truth down, verdict across)", whole.family_confusion))
    console.print(detectability_table(whole))
    missed = misses_table(outcome)
    if missed.row_count:
        console.print(missed)
    for name, error in outcome.errors.items():
        console.print(f"{name}: no verdict, {error}")
    console.print(f"{len(outcome.scores['diagnosis'])} cases in {outcome.seconds:.0f} s")


def misses_table(outcome: Outcome) -> Table:
    """Return the cases with a gap of at least three floors, or none, whose verdict is wrong, and what they were."""
    table = Table("case", "plant", "truth", "verdict", "gap/floor", "fault", "said", title="misses")
    for s in outcome.scores["diagnosis"]:
        right = (s.said == s.truth, s.stage, s.actuator, s.in_set if s.truth == "attributed" else None)
        if all(x is None or x for x in right) or (s.gap_over_floor or CLEAR) < CLEAR:
            continue
        ratio = "-" if s.gap_over_floor is None else f"{s.gap_over_floor:.1f}"
        table.add_row(s.case, s.plant, s.truth, s.said, ratio, s.fault, s.answer)
    return table


def rates_table(title: str, summaries: dict[str, Summary]) -> Table:
    """Return the table of rates: the diagnosis with number and interval beside its targets, then the baselines."""
    table = Table(title=title)
    for name in ("rate", "target", *summaries):
        table.add_column(name, no_wrap=name == "rate")
    first, *others = summaries.values()
    for name, rate in first.rates.items():
        sign, limit = TARGETS.get(name, ("", 0.0))
        target = f"{sign} {limit:g}" if sign else ""
        table.add_row(name, target, _full(rate), *(_short(other.rates[name]) for other in others))
    return table


def plants_table(title: str, summaries: dict[str, Summary]) -> Table:
    """Return the table of rates with a column per truth plant, each with number and interval."""
    table = Table(title=title)
    for name in ("rate", "target", *summaries):
        table.add_column(name, no_wrap=name == "rate")
    for name in next(iter(summaries.values())).rates:
        sign, limit = TARGETS.get(name, ("", 0.0))
        table.add_row(name, f"{sign} {limit:g}" if sign else "", *(_full(s.rates[name]) for s in summaries.values()))
    return table


def _short(rate: Rate) -> str:
    return "-" if rate.value is None else f"{rate.value:.2f}"


def _full(rate: Rate) -> str:
    interval = "" if rate.low is None else f" {rate.low:.2f}-{rate.high:.2f}"
    return "-" if rate.value is None else f"{rate.value:.3f}{interval} (n {rate.n})"


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
