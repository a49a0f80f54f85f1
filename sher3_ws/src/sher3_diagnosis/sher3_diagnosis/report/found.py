"""A discovered formula for the terminal and the page."""

from __future__ import annotations

from typing import Any, NamedTuple

from sher3_diagnosis.discover.formula import Discovery
from sher3_diagnosis.discover.sentence import component_name
from sher3_diagnosis.verdict import Interval
from sher3_diagnosis.words import place, quantity, range_text, share, words


class FoundRow(NamedTuple):
    """One term: component, formula, coefficient, interval, in how many folds it was found again, and a sentence."""

    component: str
    feature: str
    value: str
    interval: str
    again: str
    sentence: str


def found_rows(found: Discovery) -> list[FoundRow]:
    """Return the terms as they are printed."""
    rows = []
    for term, sentence in zip(found.terms, found.sentences, strict=True):
        c = term.coefficient
        name = component_name(found.channel, term.component)
        value, interval = _in_si(c.value, c.unit), range_text(c.low, c.high, "")
        if "/" not in c.unit:
            value, interval = quantity(c.value, c.unit), range_text(c.low, c.high, c.unit)
        rows.append(FoundRow(name, str(term.feature), value, interval, f"{term.again} of {found.folds}", sentence))
    return rows


def _in_si(value: float, unit: str) -> str:
    return f"{value:.4g} {unit.replace('*', '·')}"


def closures(found: Discovery) -> str:
    """Return how far the gap shrinks, beside the ceiling."""
    return (
        f"closes {_interval(found.closure)} of the gap on runs left out; boosted trees of the same inputs close "
        f"{_interval(found.ceiling)}"
    )


def _interval(value: Interval | None) -> str:
    if value is None:
        return "–"
    return share(value.value) + (f" ({share(value.low)} … {share(value.high)})" if value.low is not None else "")


def found_text(found: Discovery) -> str:
    """Return a discovery for the terminal."""
    if not found.claimed:
        text = f"formula  none: {found.note}"
        return text if found.ceiling is None else f"{text}; boosted trees close {_interval(found.ceiling)}"
    lines = [f"formula  {words(found.channel.stage)}, {place(found.channel.actuator)}: {closures(found)}"]
    for row in found_rows(found):
        name = f"{row.component} += " if row.component else ""
        lines += [f"  {name}{row.value} * {row.feature}", f"    95 %: {row.interval}; found in {row.again} parts",
                  f"    {row.sentence}"]  # fmt: skip
    return "\n".join(lines)


def found_data(found: Discovery) -> dict[str, Any]:
    """Return a discovery as plain data for `--json`."""
    return {
        "place": {"stage": found.channel.stage, "actuator": found.channel.actuator} if found.channels else None,
        "terms": [
            {"component": component_name(found.channel, t.component), "feature": str(t.feature), "again": t.again,
             "coefficient": t.coefficient.model_dump(), "sentence": s}
            for t, s in zip(found.terms, found.sentences, strict=True)
        ],
        "closure": None if found.closure is None else found.closure.model_dump(),
        "ceiling": None if found.ceiling is None else found.ceiling.model_dump(),
        "folds": found.folds,
        "note": found.note,
    }  # fmt: skip
