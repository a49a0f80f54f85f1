"""A log with holes, in its clock or of rows without a place, or whose clock jumps back: each part of it is a run."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Mask

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


def cut(name: str, tables: Tables, clock: str | None, placed: Mask | None = None) -> tuple[dict[str, Tables], str]:
    """Return the parts of a record by name, and a note; the record itself where nothing is to be cut.

    Args:
        name: of the run.
        tables: its columns.
        clock: name of the time column, where one table has it; None: no stamps, or several tables.
        placed: rows (n,) in which a place was recorded; None: all.
    """
    stamps = tables.get(clock) if clock is not None else None
    if stamps is None or stamps.ndim != 1:
        return {name: tables}, ""
    seen = np.flatnonzero(np.isfinite(stamps) & (True if placed is None else placed))
    steps = np.diff(stamps[seen])
    forward = steps[steps > 0.0]
    if len(seen) < SHORTEST or not len(forward):
        return {name: tables}, ""
    breaks = np.abs(steps) > LONGEST_HOLE * np.median(forward)
    if not breaks.any():
        return {name: tables}, ""
    at = np.flatnonzero(breaks)
    each = zip([seen[0], *seen[at + 1]], [*(seen[at] + 1), seen[-1] + 1], strict=True)
    spans = [(int(a), int(b)) for a, b in each if b - a >= SHORTEST]
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
    why = "its clock jumps back" if back else "it has holes"
    note = f"{first}: {name} is cut into {len(spans)} parts, because {why}; {left} samples are in none of them"
    return parts, note


def whole(part: str) -> str:
    """Return the name of the record that a part was cut from."""
    return part.split(MARK)[0]
