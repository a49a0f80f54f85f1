"""The clock of a chain as its recorded speeds count it, where the stamps of its log jitter."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.intake.columns import clock_beside, find, pick
from sher3_machines.intake.fields import TIME_UNITS
from sher3_machines.intake.mending.counted import counted_stamps
from sher3_machines.intake.spelling import table_of
from sher3_machines.intake.tables import Tables

from sher3_chain.joint.description import ChainDescription


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
    off = 1e3 * float(np.std(np.diff(stamps) - np.diff(counted)))
    lost = int(len(fresh) - fresh.sum())
    again = f"; {lost} rows that repeat an instant are left out" if lost else ""
    return f"{run}: stamps jitter by {off:.2g} ms: recorded speeds count whole periods, and are the clock{again}"
