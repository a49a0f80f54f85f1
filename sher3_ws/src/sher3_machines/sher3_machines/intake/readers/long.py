"""Logs with one reading a line, as monitors of a control system and data bases write them: channel, stamp, value."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.intake.readers.cells import seconds, value_of

FEWEST = 20
"""Lines from which a log is one."""
MOST_CHANNELS = 50
"""Channels of a log at most: a column with more names is one of remarks."""


def is_long(rows: Sequence[Sequence[str]]) -> bool:
    """Return whether nearly every row names a channel, then a stamp with a date, then a number.

    The date and the time of day may be parted by a blank, as `camonitor` of EPICS does.
    """
    if len(rows) < FEWEST:
        return False
    read = [_reading(row) for row in (rows[0], rows[len(rows) // 2], rows[-1])]
    readings = [_reading(row) for row in rows] if all(read[1:]) else []
    known = [reading for reading in readings if reading]
    return len(known) > 0.9 * len(rows) and len({name for name, _, _ in known}) <= MOST_CHANNELS


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
