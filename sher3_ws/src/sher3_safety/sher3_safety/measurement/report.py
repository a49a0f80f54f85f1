"""The table of the matrix, as text and as Markdown: a line per fault, its states beside each other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

from sher3_safety.measurement.recording import Outcome
from sher3_safety.measurement.verdict import Verdict
from sher3_safety.rows.row import FURTHER, STATES, Row

TRAVELS = tuple(f"travel {state.name}" for state in STATES)
HEAD = ("fault", "first reason", "detection", "stop", *TRAVELS, "travel in other states", "must", "verdict")
UNITS = ("", "", "ms", "ms", *("um",) * len(STATES), "um", "", "")


def by_row(verdicts: Iterable[Verdict]) -> dict[str, list[Verdict]]:
    """Return the verdicts of each row by its name, in order."""
    rows: dict[str, list[Verdict]] = {}
    for verdict in verdicts:
        rows.setdefault(verdict.row.name, []).append(verdict)
    return rows


def table(verdicts: Iterable[Verdict]) -> list[tuple[str, ...]]:
    """Return the lines of the table, texts under `HEAD`.

    Where the robot has to go on, travel is the distance of the tip from its undisturbed path.
    """
    return [_line(name, cells) for name, cells in by_row(verdicts).items()]


def _line(name: str, cells: Sequence[Verdict]) -> tuple[str, ...]:
    expects = cells[0].row.expects
    travel = {cell.state.name: _travel(cell.row, cell) for cell in cells}
    times = _ms(_longest_detection(cells)), _ms(_longest_stop(cells) if expects == "stops" else None)
    return (
        name,
        _first_reasons(cells),
        *times,
        *(travel.get(state.name, "") for state in STATES),
        ", ".join(f"{state.name} {travel[state.name]}" for state in FURTHER if state.name in travel),
        expects,
        _held(cells),
    )


def _first_reasons(cells: Sequence[Verdict]) -> str:
    """Return the first reported reasons of all states, each once."""
    reasons = dict.fromkeys(cell.outcome.reason for cell in cells if cell.outcome is not None and cell.outcome.reason)
    return ", ".join(reasons) or "-"


def _moving(cells: Sequence[Verdict]) -> list[Outcome]:
    """Return what was measured in the states in which the robot moves."""
    return [cell.outcome for cell in cells if cell.outcome is not None and cell.state.speed]


def _longest_detection(cells: Sequence[Verdict]) -> float | None:
    """Return the longest time to the first reaction [s], None where nothing reacted."""
    return max((o.detection for o in _moving(cells) if o.detection is not None), default=None)


def _longest_stop(cells: Sequence[Verdict]) -> float | None:
    """Return the longest time to rest [s], None where the robot did not come to rest in some state."""
    stops = [outcome.stop for outcome in _moving(cells)]
    known = [stop for stop in stops if stop is not None]
    return max(known) if known and len(known) == len(stops) else None


def _held(cells: Sequence[Verdict]) -> str:
    """Return the verdict of a row: fine in every state, or the number of states that miss."""
    missed = sum(not cell.holds for cell in cells)
    if missed:
        return f"MISS {missed} of {len(cells)}"
    return "residual" if cells[0].row.expects in ("residual", "said") else "ok"


def _travel(row: Row, cell: Verdict) -> str:
    if cell.outcome is None:
        return "?"
    if row.expects == "ends":
        return "-"
    far = row.expects in ("stops", "residual", "said") and not row.slow
    metres = cell.outcome.travel if far else cell.outcome.excess
    return f"{metres * 1e6:.1f}"


def _ms(seconds: float | None) -> str:
    return "-" if seconds is None else f"{seconds * 1e3:.0f}"


def misses(verdicts: Iterable[Verdict]) -> list[str]:
    """Return a sentence for each cell that misses."""
    return [f"{v.row.name}, {v.state.name}: {'; '.join(v.misses)}" for v in verdicts if v.misses]


def nearest_to_budget(verdicts: Sequence[Verdict]) -> str:
    """Return a sentence on the cell that had to stop and came nearest to its budget; empty without one."""
    shares = []
    for verdict in verdicts:
        row, outcome = verdict.row, verdict.outcome
        if row.expects == "stops" and outcome is not None:
            travel = outcome.excess if row.slow else outcome.travel
            budget = verdict.state.budget if row.budget is None else row.budget
            shares.append(
                (travel / budget, f"{row.name}, {verdict.state.name}: {travel * 1e6:.1f} of {budget * 1e6:g} um")
            )
    return f"Nearest to its budget: {max(shares)[1]}." if shares else ""


def as_text(verdicts: Sequence[Verdict]) -> str:
    """Return the table for a terminal."""
    lines = [HEAD, UNITS, *table(verdicts)]
    widths = [max(len(line[column]) for line in lines) for column in range(len(HEAD))]
    return "\n".join(
        "  ".join(text.ljust(width) for text, width in zip(line, widths, strict=True)).rstrip() for line in lines
    )


def as_markdown(title: str, verdicts: Sequence[Verdict], notes: Iterable[str] = ()) -> str:
    """Return the report: the table, what misses, and what goes on and why."""
    heads = [f"{name} [{unit}]" if unit else name for name, unit in zip(HEAD, UNITS, strict=True)]
    lines = [f"# {title}", "", *notes, "", f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    lines += [f"| {' | '.join(line)} |" for line in table(verdicts)]
    if missed := misses(verdicts):
        lines += ["", "## Misses", *(f"- {text}" for text in missed)]
    reasons = {v.row.name: v.row.why for v in verdicts if v.row.why}
    if reasons:
        lines += ["", "## What goes on, and why", *(f"- {name}: {why}" for name, why in reasons.items())]
    return "\n".join(lines) + "\n"


def false_trips(trips: int, hours: float) -> dict[str, Any]:
    """Return the rate of false trips with its one-sided 95 % bound (Poisson; for no trip -ln 0.05 over the time)."""
    from scipy.stats import chi2

    upper = float(chi2.ppf(0.95, 2 * trips + 2)) / 2.0 / hours if hours > 0.0 else math.inf
    rate = trips / hours if hours > 0.0 else math.nan
    return {"trips": trips, "hours": hours, "per_hour": rate, "upper_95": upper}
