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


def spread(name: str, tables: Tables, stamps: Mapping[str, Array], most: int) -> tuple[dict[str, Tables], str]:
    """Return stretches of a record by name, and a note; the record itself where it has at most `most` rows.

    Args:
        name: of the run.
        tables: its columns.
        stamps: column -> clock of its table; columns without one stay whole.
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
