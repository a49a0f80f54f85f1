"""A table of several machines: a column of text says of which one a row is, and each has stamps of its own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.intake.readers.cells import value_of
from sher3_machines.intake.readers.shapes import SAMPLES

MOST = 50
"""Machines of a table at most: a column with more words is one of remarks."""
TOGETHER = 10.0
"""Periods between whose first stamps, and last ones, those of machines lie that were logged together: runs differ."""


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
            if len(parts) > MOST:
                break
        if 2 <= len(parts) <= MOST and "" not in parts and min(map(len, parts.values())) >= SAMPLES:
            numbers = [j for j in range(len(middle)) if isinstance(value_of(middle[j], comma), float)]
            if any(_stamps(j, rows, list(parts.values()), comma) for j in numbers):
                return parts
    return {}


def _stamps(column: int, rows: Sequence[Sequence[str]], parts: Sequence[Sequence[Sequence[str]]], comma: bool) -> bool:
    """Return whether a column runs forward in each part over one stretch, and not through all rows."""
    each = [_numbers(column, part, comma) for part in parts]
    if not all((np.diff(x) > 0.0).all() for x in each) or (np.diff(_numbers(column, rows, comma)) > 0.0).all():
        return False
    slowest = max(float(np.ptp(x)) / (len(x) - 1) for x in each)
    return max(np.ptp([x[0] for x in each]), np.ptp([x[-1] for x in each])) <= TOGETHER * slowest


def _numbers(column: int, rows: Sequence[Sequence[str]], comma: bool) -> Array:
    """Return the numbers (n,) of a column, nan of any other cell."""
    values = (value_of(row[column], comma) if column < len(row) else None for row in rows)
    return np.array([x if isinstance(x, float) else np.nan for x in values])
