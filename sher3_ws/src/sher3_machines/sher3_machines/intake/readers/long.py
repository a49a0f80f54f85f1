"""Tables in which a column of text says whose a row is.

Monitors of a control system and data bases write one reading a line: channel, stamp, value. Loggers of several machines
write the machine beside its signals.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.intake.readers.cells import seconds, value_of
from sher3_machines.intake.readers.shapes import SAMPLES

FEWEST = 20
"""Lines from which a log is one."""
MOST_NAMES = 50
"""Channels or machines of a log at most: a column with more names is one of remarks."""
TOGETHER = 10.0
"""Periods between whose first stamps, and last ones, those of machines lie that were logged together: runs differ."""


def is_long(rows: Sequence[Sequence[str]]) -> bool:
    """Return whether nearly every row names a channel, then a stamp with a date, then a number.

    The date and the time of day may be parted by a blank, as `camonitor` of EPICS does.
    """
    if len(rows) < FEWEST:
        return False
    read = [_reading(row) for row in (rows[0], rows[len(rows) // 2], rows[-1])]
    readings = [_reading(row) for row in rows] if all(read[1:]) else []
    known = [reading for reading in readings if reading]
    return len(known) > 0.9 * len(rows) and len({name for name, _, _ in known}) <= MOST_NAMES


def tables_of_readings(rows: Sequence[Sequence[str]]) -> dict[str, Array]:
    """Return of each channel `NAME/stamp` (n,), s since 1970, and `NAME/value` (n,)."""
    channels: dict[str, list[tuple[float, float]]] = {}
    for reading in map(_reading, rows):
        if reading is not None:
            channels.setdefault(reading[0].replace("/", "_"), []).append(reading[1:])
    found: dict[str, Array] = {}
    for name, readings in channels.items():
        stamps, values = np.array(sorted(readings), dtype=float).T
        found[f"{name}/stamp"], found[f"{name}/value"] = stamps, values
    return found


def _reading(row: Sequence[str]) -> tuple[str, float, float] | None:
    """Return channel, stamp and value of a row; None of any other."""
    if len(row) < 3 or value_of(row[0], False) is not None:
        return None
    joined = seconds(row[1].strip())
    stamp, rest = (joined, row[2:]) if joined is not None else (seconds(f"{row[1]} {row[2]}".strip()), row[3:])
    value = value_of(rest[0], False) if rest else None
    return (row[0].strip(), stamp, value) if stamp is not None and isinstance(value, float) else None


def machines_of(rows: Sequence[Sequence[str]], comma: bool) -> dict[str, list[Sequence[str]]]:
    """Return machine -> its rows, of a table (without header) in which a column of text names the machine of each row.

    Stamps run forward within each machine and not through the table, and all were logged over one stretch of time. {}
    of any other table: a state is told in stamps that run on, and runs begin or end apart.

    Args:
        rows: cells as text.
        comma: whether a comma is the decimal mark.
    """
    middle = rows[len(rows) // 2] if rows else []
    texts = [i for i, cell in enumerate(middle) if cell.strip() and value_of(cell, comma) is None]
    for i in texts:
        parts: dict[str, list[Sequence[str]]] = {}
        for row in rows:
            parts.setdefault(row[i].strip().replace("/", "_") if i < len(row) else "", []).append(row)
            if len(parts) > MOST_NAMES:
                break
        if 2 <= len(parts) <= MOST_NAMES and "" not in parts and min(map(len, parts.values())) >= SAMPLES:
            numbers = [j for j in range(len(middle)) if isinstance(value_of(middle[j], comma), float)]
            if any(_stamps(j, rows, list(parts.values()), comma) for j in numbers):
                return parts
    return {}


def _stamps(column: int, rows: Sequence[Sequence[str]], parts: Sequence[Sequence[Sequence[str]]], comma: bool) -> bool:
    """Return whether a column runs forward in each part over one stretch, and not through all rows."""
    each = [_column(column, part, comma) for part in parts]
    if not all((np.diff(x) > 0.0).all() for x in each) or (np.diff(_column(column, rows, comma)) > 0.0).all():
        return False
    slowest = max(float(np.ptp(x)) / (len(x) - 1) for x in each)
    return max(np.ptp([x[0] for x in each]), np.ptp([x[-1] for x in each])) <= TOGETHER * slowest


def _column(column: int, rows: Sequence[Sequence[str]], comma: bool) -> Array:
    """Return the numbers (n,) of a column, nan of any other cell."""
    values = (value_of(row[column], comma) if column < len(row) else None for row in rows)
    return np.array([x if isinstance(x, float) else np.nan for x in values])
