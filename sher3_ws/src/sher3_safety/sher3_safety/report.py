"""The table of the matrix, as text and as Markdown: a line per fault, its states beside each other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

from .matrix import STATES, Row
from .verdict import Verdict

HEAD = ("fault", "first reason", "detection", "stop", *(f"travel {state.name}" for state in STATES), "must", "verdict")
UNITS = ("", "", "ms", "ms", *("um",) * len(STATES), "", "")


def by_row(verdicts: Iterable[Verdict]) -> dict[str, list[Verdict]]:
    """Return the verdicts of each row by its name, in order."""
    rows: dict[str, list[Verdict]] = {}
    for verdict in verdicts:
        rows.setdefault(verdict.row.name, []).append(verdict)
    return rows


def table(verdicts: Iterable[Verdict]) -> list[tuple[str, ...]]:
    """Return the lines of the table, texts under `HEAD`; of what goes on, travel is the distance off its way."""
    return [_line(name, cells) for name, cells in by_row(verdicts).items()]


def _line(name: str, cells: Sequence[Verdict]) -> tuple[str, ...]:
    row = cells[0].row
    outcomes = [cell.outcome for cell in cells if cell.outcome is not None]
    reasons = dict.fromkeys(o.reason for o in outcomes if o.reason)
    moving = [c.outcome for c in cells if c.outcome is not None and c.state.speed]
    detection = max((o.detection for o in moving if o.detection is not None), default=None)
    stops = [o.stop for o in moving] if row.effect == "stops" else []
    stop = None if not stops or None in stops else max(value for value in stops if value is not None)
    travels = {cell.state.name: _travel(row, cell) for cell in cells}
    held = sum(cell.holds for cell in cells)
    fine = "residual" if row.effect == "residual" else "ok"
    verdict = fine if held == len(cells) else f"MISS {len(cells) - held} of {len(cells)}"
    columns = (name, ", ".join(reasons) or "-", _ms(detection), _ms(stop))
    return (*columns, *(travels.get(state.name, "") for state in STATES), row.effect, verdict)


def _travel(row: Row, cell: Verdict) -> str:
    if cell.outcome is None:
        return "?"
    if row.effect == "ends":
        return "-"
    metres = cell.outcome.travel if row.effect in ("stops", "residual") else cell.outcome.excess
    return f"{metres * 1e6:.1f}"


def _ms(seconds: float | None) -> str:
    return "-" if seconds is None else f"{seconds * 1e3:.0f}"


def misses(verdicts: Iterable[Verdict]) -> list[str]:
    """Return a sentence for each cell that misses."""
    return [f"{v.row.name}, {v.state.name}: {'; '.join(v.misses)}" for v in verdicts if v.misses]


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
