"""One record of readings: named columns in SI units, with the checks that every table has to pass."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel
from scipy.constants import g
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import IN_HEADER, pick_beside
from sher3_machines.intake.fields import Column
from sher3_machines.intake.tables import Tables
from sher3_machines.intake.units import spelled

Labels = NDArray[Any]
"""(g,) a number for each row: of its run, or of the part that is held out together."""

LACKING = 0.25
"""Share of the rows that may lack a number: with more of them a column is wrong, and no reading."""
MOST_ROWS = 5000
"""Readings that are used; of more every n-th counts, since neighbours tell the same."""


@dataclass(frozen=True)
class Readings:
    """The readings of one file, n rows.

    Attributes:
        name: of the file.
        columns: name -> (n, ...), SI.
        notes: what was done to the data.
    """

    name: str
    columns: Mapping[str, Array]
    notes: Sequence[str] = ()

    def __getitem__(self, column: str) -> Array:
        return self.columns[column]


def joined(runs: Sequence[Readings]) -> dict[str, NDArray[Any]]:
    """Return the columns of all runs after each other, and as `run` (g,) the number of each row's run."""
    columns = {name: np.concatenate([run[name] for run in runs]) for name in runs[0].columns}
    return {**columns, "run": np.repeat(np.arange(len(runs)), [len(next(iter(r.columns.values()))) for r in runs])}


def whole_rows(name: str, tables: Tables, description: BaseModel) -> tuple[Tables, str]:
    """Return a table without the rows that lack a number of a column that the description names, and a note on them."""
    named = [tables[c.column] for c in columns_in(description) if c.column in tables]
    rows = len(named[0]) if named else 0
    if not rows or any(len(x) != rows for x in named):
        return tables, ""
    kept = np.all([np.isfinite(x.reshape(rows, -1)).all(axis=1) for x in named], axis=0)
    lacking = rows - int(kept.sum())
    if not 0 < lacking <= LACKING * rows:
        return tables, ""
    note = f"{name}: {lacking} of {rows} rows lack a number and are no readings"
    return {n: x[kept] if len(x) == rows else x for n, x in tables.items()}, note


def columns_in(part: object) -> Iterator[Column]:
    """Yield the columns that a part of a description names."""
    if isinstance(part, Column):
        yield part
    inner = part.__dict__.values() if isinstance(part, BaseModel) else part if isinstance(part, tuple) else ()
    for x in inner:
        yield from columns_in(x)


def as_weight(column: Column) -> float:
    """Return what makes a weight of a known load, N per unit of the column: g, m/s^2, of kilograms without a factor."""
    header = IN_HEADER.fullmatch(column.column)
    unit = column.unit or (spelled(header["unit"]) if header else None)
    return g if unit == "kg" and column.factor == 1.0 else 1.0


def enough(what: str, found: int, least: int, remedy: str) -> None:
    """Raise MachineError where fewer were found than are needed."""
    if found < least:
        raise MachineError(f"{what}", value=found, limit=least, remedy=remedy)


def alive(what: str, reading: Array, remedy: str) -> None:
    """Raise MachineError where a channel (n,) never changes."""
    if not np.ptp(reading):
        raise MachineError(f"{what} never changes", value=f"{reading[0]:.6g}", remedy=remedy)


def thinned(name: str, columns: Mapping[str, Array]) -> Readings:
    """Return the readings (rows,) of one file; of more than `MOST_ROWS` every second, third..., which a note says."""
    rows = len(next(iter(columns.values())))
    step = -(-rows // MOST_ROWS)
    notes = [f"{name}: every {step}th of {rows} readings is used"] if step > 1 else []
    return Readings(name, {column: x[::step] for column, x in columns.items()}, notes)


def temperature(column: Column | None, rows: int, tables: Tables, name: str) -> Array:
    """Return temperatures (n,), deg C; nan where none were recorded."""
    return np.full(rows, np.nan) if column is None else pick_beside((rows,), column, tables, name)


def warmed(runs: Sequence[Readings]) -> Array:
    """Return how much warmer each reading is than the first of its run, (g,), K; zero where it was not recorded."""
    return np.nan_to_num(np.concatenate([run["temperature"] - run["temperature"][0] for run in runs]))


def scatter_beyond(columns: Array, reading: Array) -> tuple[Array, int]:
    """Return the standard deviation (d,) of readings (g, d) beyond what columns (g, p) explain, and what is left free.

    Without a degree of freedom the standard deviation is that of the residual itself.
    """
    left = reading - columns @ np.linalg.lstsq(columns, reading, rcond=None)[0]
    free = len(reading) - int(np.linalg.matrix_rank(columns))
    return np.sqrt(np.sum(left**2, axis=0) / max(free, 1)), free


def one_hot(labels: Labels) -> Array:
    """Return indicator columns (g, k) of labels 0 .. k - 1: 1 in the rows of a label, else 0."""
    return np.eye(int(labels.max()) + 1)[labels.astype(int)]


def same(*conditions: Array) -> Array:
    """Return indicator columns (g, k), one for each combination of conditions (g,) that occurs."""
    return one_hot(np.unique(np.column_stack(conditions), axis=0, return_inverse=True)[1].ravel())
