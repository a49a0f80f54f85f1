"""Columns of the data as SI values, and the stamps that belong to them."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.errors import MachineError
from sher3_machines.intake.fields import Clock, Column
from sher3_machines.intake.tables import Tables


def pick(column: Column, tables: Tables, run: str) -> Array:
    """Return the samples of a column in SI units, (n,) or (n, ...).

    Raises:
        MachineError: the column or its entry is missing, or a sample is not finite.
    """
    if column.column not in tables:
        have = ", ".join(sorted(tables)) or "none"
        raise MachineError(
            f"{run}: no column {column.column!r}", limit=f"columns: {have}", remedy="name it as the data do"
        )
    x = tables[column.column]
    if column.index is not None:
        if x.ndim < 2 or not 0 <= column.index < x.shape[1]:
            width = x.shape[1] if x.ndim > 1 else 1
            raise MachineError(
                f"{run}: {column.column} has no entry", value=column.index, limit=width, remedy="correct index"
            )
        x = x[:, column.index]
    bad = ~np.isfinite(x.reshape(len(x), -1)).all(axis=1)
    if bad.any():
        raise MachineError(
            f"{run}: {column.column} is not finite at sample {int(np.argmax(bad))}",
            value=f"{int(bad.sum())} of {len(x)} samples",
            remedy="cut the record before or after",
        )
    return x * column.scale


def stamps_of(column: Column, tables: Tables, clock: Clock, run: str) -> Array | None:
    """Return the stamps (n,) in s of the table a column is in; None where the clock is a rate."""
    if clock.column is None:
        return None
    table = column.column.rsplit("/", 1)[0] + "/" if "/" in column.column else ""
    name = table + clock.column if table + clock.column in tables else clock.column
    return pick(Column(column=name, unit=clock.unit), tables, run)
