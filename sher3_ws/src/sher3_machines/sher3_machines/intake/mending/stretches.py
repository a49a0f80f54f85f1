"""A record with more readings than an answer needs: stretches of it, evenly spread, are judged in place of all."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.intake.mending.parts import MARK
from sher3_machines.intake.tables import Tables

MOST_READINGS = 2_000_000
"""Readings that are judged of one call: an arm of seven joints then has its answer within a minute of one core, and two
minutes of motion at 1 kHz."""
STRETCHES = 12
"""Stretches that a long record is judged by: each of several seconds, and what changes in an hour is seen."""

FEWEST = 4
"""Repeats of one motion that are judged at least: six pairs of them say what repeats differ by."""


def repeats_judged(records: Mapping[str, Tables], columns: int) -> tuple[dict[str, Tables], str]:
    """Return as many whole repeats of one motion as an answer needs, evenly spread over all, by name, and a note.

    Args:
        records: name -> columns of a repeat.
        columns: whose readings count.
    """
    rows = max((len(x) for tables in records.values() for x in tables.values() if x.ndim), default=0)
    count = max(FEWEST, MOST_READINGS // max(columns * rows, 1))
    names = list(records)
    if len(names) <= count:
        return dict(records), ""
    kept = [names[i] for i in np.linspace(0, len(names) - 1, count).round().astype(int)]
    note = (
        f"{len(names)} repeats have more readings than an answer needs: {count} of them, evenly spread, are judged; "
        "give other ones by themselves to have them judged"
    )
    return {name: records[name] for name in kept}, note


def beginning(name: str, tables: Tables, stamps: Mapping[str, Array], most: int) -> tuple[Tables, str]:
    """Return the beginning of a repeat, where all are alike, and a note; all of it where it has at most `most` rows.

    Columns are (n, ...), and the clock of each in `stamps` is (n,).
    """
    rows = max((len(x) for x in stamps.values()), default=0)
    if rows <= most:
        return tables, ""
    start, end = max(float(np.min(x)) for x in stamps.values()), min(float(np.max(x)) for x in stamps.values())
    last = start + (end - start) * most / rows
    found = {c: x[_within(stamps[c], start, last)] if c in stamps else x for c, x in tables.items()}
    return found, f"{name}: has {rows} rows, more than an answer needs: its first {most / rows:.0%} is judged"


def spread(name: str, tables: Tables, stamps: Mapping[str, Array], most: int) -> tuple[dict[str, Tables], str]:
    """Return stretches of a record by name, and a note; the record itself where it has at most `most` rows.

    Args:
        name: of the run.
        tables: its columns (n, ...).
        stamps: column -> clock (n,) of its table; columns without one stay whole.
        most: rows that all stretches together may have, of the clock with most.
    """
    rows = max((len(x) for x in stamps.values()), default=0)
    if rows <= most:
        return {name: tables}, ""
    start, end = max(float(np.min(x)) for x in stamps.values()), min(float(np.max(x)) for x in stamps.values())
    length = (end - start) * most / rows / STRETCHES
    firsts = np.linspace(start, end - length, STRETCHES)
    parts = {
        f"{name}{MARK}{i + 1}": {
            c: x[_within(stamps[c], a, a + length)] if c in stamps else x for c, x in tables.items()
        }
        for i, a in enumerate(firsts)
    }
    note = (
        f"{next(iter(parts))}: {name} has {rows} rows, more than an answer needs: {STRETCHES} stretches of it, evenly "
        f"spread, are judged, {most / rows:.0%} of it; give another part of it as a run to have it judged"
    )
    return parts, note


def _within(stamps: Array, first: float, last: float) -> slice:
    """Return the rows from one stamp to another."""
    inside = np.flatnonzero((stamps >= first) & (stamps < last))
    return slice(int(inside[0]), int(inside[-1]) + 1) if len(inside) else slice(0, 0)
