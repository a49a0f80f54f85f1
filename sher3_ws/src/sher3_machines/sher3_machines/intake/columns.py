"""Columns of the data as SI values, and the stamps that belong to them."""

from __future__ import annotations

import re
from difflib import get_close_matches

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.errors import MachineError
from sher3_machines.intake.fields import Clock, Column
from sher3_machines.intake.spelling import table_of
from sher3_machines.intake.tables import Tables
from sher3_machines.intake.units import UNITS, spelled

IN_HEADER = re.compile(r"(?P<name>.*?)\s*[\[(](?P<unit>[^\])]+)[\])]")
"""A column's header with its unit: `q [mm]`, `current (A)`."""
MOTION = "motion"
"""Word of a description for the sign of the motion."""
NEAR = 5
"""Columns of similar names that a refusal lists."""


def pick(column: Column, tables: Tables, run: str, finite: bool = True) -> Array:
    """Return the samples of a column in SI units, (n,) or (n, ...).

    Args:
        column: of the description.
        tables: columns of the data.
        run: name of the run.
        finite: whether a sample that is not finite is refused.

    Raises:
        MachineError: the column or its entry is missing, its unit is not stated or another than its header's, or a
            sample is not finite.
    """
    name = find(column.column, tables, run)
    x = tables[name]
    if column.index is not None:
        if x.ndim < 2 or not 0 <= column.index < x.shape[1]:
            width = x.shape[1] if x.ndim > 1 else 1
            raise MachineError(
                f"{run}: {column.column} has no entry", value=column.index, limit=width, remedy="correct index"
            )
        x = x[:, column.index]
    if not x.size:
        raise MachineError(f"{run}: {column.column} is empty", value=x.shape, limit="1 sample", remedy="record again")
    bad = ~np.isfinite(x.reshape(len(x), -1)).all(axis=1)
    if finite and bad.any():
        raise MachineError(
            f"{run}: {column.column} is not finite at sample {int(np.argmax(bad))}",
            value=f"{int(bad.sum())} of {len(x)} samples",
            remedy="cut the record before or after",
        )
    x = acting(x, column.within) * scale(column, name, run) + column.offset
    if column.signed_by not in (None, MOTION):
        other = Column(column=str(column.signed_by), unit="1", override=True)
        x = np.abs(x) * np.sign(pick_beside(x.shape, other, tables, run, finite))
    return _with_others(x, column, tables, run, finite)


def acting(x: Array, within: tuple[float, float] | None) -> Array:
    """Return what acts of recorded numbers (n, ...): of one beyond its bounds the bound, of an infinite one nothing."""
    finite = np.where(np.isinf(x), np.nan, x)
    return finite if within is None else np.clip(finite, *within)


def _with_others(x: Array, column: Column, tables: Tables, run: str, finite: bool) -> Array:
    """Return samples with those of the columns that the description adds to them."""
    for other in column.plus:
        x = x + pick_beside(x.shape, other, tables, run, finite, "add columns of one table")
    return x


def pick_beside(
    shape: tuple[int, ...],
    column: Column,
    tables: Tables,
    run: str,
    finite: bool = True,
    remedy: str = "name columns of one table, one number in each row",
) -> Array:
    """Return the samples (n, ...) of a column as `pick` does; raises MachineError where they have another shape."""
    x = pick(column, tables, run, finite)
    if x.shape != shape:
        raise MachineError(f"{run}: {column.column} has other rows", value=x.shape, limit=shape, remedy=remedy)
    return x


def find(name: str, tables: Tables, run: str) -> str:
    """Return the column of a name, or the one that has it with a unit behind; raises MachineError without one."""
    if name in tables:
        return name
    units = [x for x in tables if (match := IN_HEADER.fullmatch(x)) and match["name"] == name]
    if len(units) == 1:
        return units[0]
    near = get_close_matches(name, tables, NEAR, 0.3) or sorted(tables)[:NEAR]
    have = ", ".join(near) + (f" and {len(tables) - len(near)} more" if len(tables) > len(near) else "")
    raise MachineError(
        f"{run}: no column {name!r}", limit=f"columns: {have or 'none'}", remedy="name it as the data do"
    )


def scale(column: Column, header: str, run: str) -> float:
    """Return the factor from recorded numbers to SI; raises MachineError where no unit is stated, or two are."""
    match = IN_HEADER.fullmatch(header)
    said = spelled(match["unit"]) if match else ""
    if column.unit is None and said not in UNITS:
        raise MachineError(
            f"{run}: the unit of {column.column} is not stated",
            value=said or "none",
            limit=", ".join(UNITS),
            remedy="give `unit` in the description",
        )
    if column.unit is not None and not column.override and said in UNITS and UNITS[said] != UNITS[column.unit]:
        remedy = "correct `unit` in the description, or leave it out; where the header is wrong, add `override: true`"
        raise MachineError(f"{run}: {column.column} is in another unit", value=said, limit=column.unit, remedy=remedy)
    return column.factor * UNITS[column.unit or said]


def _clock_column(name: str, clock: Clock) -> Column:
    """Return the column of the stamps: a unit in its header is the right one where the description has the default."""
    match = IN_HEADER.fullmatch(name)
    stated = match is not None and spelled(match["unit"]) in UNITS and "unit" not in clock.model_fields_set
    return Column(column=name, unit=None if stated else clock.unit, index=clock.index, override=clock.override)


def stamps_of(column: Column, tables: Tables, clock: Clock, run: str) -> Array | None:
    """Return the stamps (n,) in s of the table a column is in; None where the clock is a rate.

    A table of another clock has its offset added; the offset of the longest name that fits counts.
    """
    home = table_of(column.column)
    name = clock_beside(home, tables, clock, run)
    if name is None:
        return None
    stamps = pick(_clock_column(name, clock), tables, run, finite=False)
    known = [x for x in clock.offsets if f"{home}/".startswith(x.rstrip("/") + "/")]
    return stamps + (clock.offsets[max(known, key=len)] if known else 0.0)


def clock_beside(table: str, tables: Tables, clock: Clock, run: str) -> str | None:
    """Return the stamps that belong to a table: its own, else as the clock names them; None for a rate."""
    if clock.column is None:
        return None
    try:
        return find(f"{table}/{clock.column}" if table else clock.column, tables, run)
    except MachineError:
        return clock.column
