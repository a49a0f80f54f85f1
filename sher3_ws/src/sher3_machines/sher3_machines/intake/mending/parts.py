"""A log with holes, in its clock or of rows without a place, or whose clock jumps back: each part of it is a run."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from sher3_diagnosis.channel import Array, Mask

from sher3_machines.intake.mending.stamps import counted_on
from sher3_machines.intake.tables import Tables

LONGEST_HOLE = 10.0
"""Periods without a sample that are interpolated over; at a longer hole a record is cut."""
SHORTEST = 20
"""Samples of a part below which it is left out."""
MOST = 50
"""Parts that are judged at most, the longest."""
HELD = 0.5
"""Share of the samples that those parts hold at least: else it is no record that was cut, but has no clock."""
USUAL = 0.99
"""Share of the steps of a column that are usual ones."""
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
    if clock is None or stamps is None or stamps.ndim != 1:
        return {name: tables}, ""
    on, end = counted_on(stamps)
    if end and _goes_on([x for n, x in tables.items() if n != clock], np.diff(stamps) < 0.0):
        parts, note = cut(name, {**tables, clock: on}, clock, placed)
        said = f"{next(iter(parts))}: its clock starts again after {end:g}; it is counted on"
        return parts, f"{said}; {note}" if note else said
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


def _goes_on(columns: Collection[Array], back: Mask) -> bool:
    """Return whether no column steps further than usual where the clock jumps back (n - 1,): what restarts does.

    What seldom changes, such as a command in steps, tells nothing.
    """
    own = (x for x in columns if x.shape == (len(back) + 1,) and np.issubdtype(x.dtype, np.number))
    steps = [np.abs(np.diff(x.astype(float))) for x in own]
    usual = [(float(np.nanmax(s[back])), float(np.nanquantile(s[~back], USUAL))) for s in steps]
    moving = [(there, most) for there, most in usual if most > 0.0]
    return bool(moving) and all(there <= most for there, most in moving)


def whole(part: str) -> str:
    """Return the name of the record that a part was cut from."""
    return part.split(MARK)[0]
