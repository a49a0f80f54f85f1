"""A log with holes or a clock that jumps back is several records: it is cut there, and each part is a run."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from sher3_machines.intake.tables import Tables

LONGEST_HOLE = 10.0
"""Periods without a sample that are interpolated over; at a longer hole a record is cut."""
SHORTEST = 20
"""Samples of a part below which it is left out."""
MOST = 50
"""Parts that are judged at most, the longest."""
HELD = 0.5
"""Share of the samples that those parts hold at least: else it is no record that was cut, but has no clock."""
MARK = ".part"
"""What parts the name of a run from the number of its part."""


def cut(name: str, tables: Tables, clock: str | None) -> tuple[dict[str, Tables], str]:
    """Return the parts of a record by name, and a note; the record itself where nothing is to be cut.

    Args:
        name: of the run.
        tables: its columns.
        clock: name of the time column, where one table has it; None: no stamps, or several tables.
    """
    stamps = tables.get(clock) if clock is not None else None
    if stamps is None or stamps.ndim != 1 or len(stamps) < SHORTEST or not np.isfinite(stamps).all():
        return {name: tables}, ""
    steps = np.diff(stamps)
    forward = steps[steps > 0.0]
    if not len(forward):
        return {name: tables}, ""
    breaks = np.abs(steps) > LONGEST_HOLE * np.median(forward)
    if not breaks.any():
        return {name: tables}, ""
    edges = [0, *(int(i) + 1 for i in np.flatnonzero(breaks)), len(stamps)]
    spans = [(a, b) for a, b in pairwise(edges) if b - a >= SHORTEST]
    spans = sorted(sorted(spans, key=lambda span: span[0] - span[1])[:MOST])
    left = len(stamps) - sum(b - a for a, b in spans)
    if left > (1.0 - HELD) * len(stamps):
        return {name: tables}, ""
    parts = {
        f"{name}{MARK}{i + 1}": {n: x[a:b] if len(x) == len(stamps) else x for n, x in tables.items()}
        for i, (a, b) in enumerate(spans)
    }
    first = next(iter(parts))
    back = bool((steps[breaks] < 0.0).any())
    why = "its clock jumps back" if back else "its clock has holes"
    note = f"{first}: {name} is cut into {len(spans)} parts, because {why}; {left} samples are in none of them"
    return parts, note


def whole(part: str) -> str:
    """Return the name of the record that a part was cut from."""
    return part.split(MARK)[0]
