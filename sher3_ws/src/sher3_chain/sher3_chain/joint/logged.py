"""What a log of a chain does to its readings: forces without a sign, clocks that jitter, speeds for places."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import IN_HEADER, clock_beside, find, pick
from sher3_machines.intake.fields import TIME_UNITS, VELOCITIES, Clock, Column
from sher3_machines.intake.mending.counted import counted_stamps, is_even
from sher3_machines.intake.mending.fields import signed
from sher3_machines.intake.spelling import table_of
from sher3_machines.intake.tables import Tables
from sher3_machines.intake.units import spelled

from sher3_chain.joint.description import ChainDescription

SIGNED = ("command", "effort", "nominal_effort", "applied", "velocity")
"""Signals that may be below zero and have no counter: places are joined where theirs starts again."""
ALTERNATING = -0.5
"""Correlation of a speed with that of the row before, below which rows are no instants: noise has -0.5 at the least."""


def with_signs(tables: Tables, machine: ChainDescription, run: str) -> tuple[Tables, list[str]]:
    """Return the tables with the sign of forces and speeds that a field took from them, and a note for each."""
    described = [(a.name, which, getattr(a.signals, which)) for a in machine.chain for which in SIGNED]
    out, notes = dict(tables), []
    for axis, which, column in described:
        name = None if column is None else find(column.column, tables, run)
        if name is None or tables[name].ndim != 1:
            continue
        out[name], said = signed(tables[name])
        notes += [f"{run}: {axis}.{which} ({name}) has {said} has; signed"] if said else []
    return out, notes


def with_counted_clock(tables: Tables, machine: ChainDescription, run: str) -> tuple[Tables, list[str]]:
    """Return the tables with the clock that the motion counts and without rows that repeat an instant, and a note.

    The same tables where the clock is a rate, where speeds were not recorded beside it, or where they tell no other
    one.
    """
    pairs = [(a.signals.position, a.signals.velocity) for a in machine.chain if a.signals.velocity is not None]
    columns = [c for pair in pairs for c in pair]
    homes = {table_of(find(c.column, tables, run)) for c in columns}
    if machine.time.column is None or len(homes) != 1 or machine.time.offsets:
        return tables, []
    home = homes.pop()
    clock = find(str(clock_beside(home, tables, machine.time, run)), tables, run)
    values = [tables[clock], *(pick(c, tables, run, finite=False) for c in columns)]
    if len({x.shape for x in values}) != 1 or values[0].ndim != 1 or not np.isfinite(np.array(values, float)).all():
        return tables, []
    scale = TIME_UNITS[machine.time.unit]
    stamps = counted_stamps(scale * values[0], np.column_stack(values[1::2]), np.column_stack(values[2::2]))
    if stamps is None:
        return tables, []
    fresh = np.concatenate([[True], np.diff(stamps) > 0.0])
    rows = {c: x[fresh] for c, x in tables.items() if table_of(c) == home and x.ndim and len(x) == len(fresh)}
    return {**tables, **rows, clock: stamps[fresh] / scale}, [_note(run, scale * values[0], stamps, fresh)]


def _note(run: str, stamps: Array, counted: Array, fresh: Array) -> str:
    """Return what is said of a clock that was counted."""
    if is_even(stamps):
        more = float((counted[-1] - counted[0]) / (stamps[-1] - stamps[0]) - 1.0)
        return f"{run}: lost rows that its even stamps do not tell: by recorded speeds it took {more:.0%} longer"
    off = 1e3 * float(np.std(np.diff(stamps) - np.diff(counted)))
    lost = int(len(fresh) - fresh.sum())
    again = f"; {lost} rows that repeat an instant are left out" if lost else ""
    return f"{run}: stamps jitter by {off:.2g} ms: recorded speeds count whole periods, and are the clock{again}"


def is_speed(column: Column, tables: Tables, run: str) -> bool:
    """Return whether a column is in a unit of velocity, as the description or its header says; raises MachineError."""
    match = IN_HEADER.fullmatch(find(column.column, tables, run))
    return (column.unit or (spelled(match["unit"]) if match else "")) in VELOCITIES


def in_time(x: Array, what: str) -> None:
    """Refuse speeds (n,) that turn back at every row, as a table of both senses does; raises MachineError."""
    known = x[np.isfinite(x)]
    about = known - known.mean()
    power = float(about @ about)
    alike = float(about[1:] @ about[:-1]) / power if power > 0.0 else 0.0
    if alike < ALTERNATING:
        raise MachineError(
            f"{what} turns back at every row: a table of speeds, and no record in time",
            value=f"{alike:.2f} alike from row to row",
            limit=f"{ALTERNATING}",
            remedy="give the record that the table was made of, its rows in the order in which they were taken",
        )


def integrated(stamps: Array | None, x: Array, clock: Clock) -> Array:
    """Return the place (n,) that a velocity (n,), m/s or rad/s, adds up to from zero on (trapezes)."""
    steps = np.diff(stamps) if stamps is not None else np.full(len(x) - 1, 1.0 / (clock.rate or 1.0))
    return np.concatenate([[0.0], np.cumsum(0.5 * (x[1:] + x[:-1]) * steps)])
