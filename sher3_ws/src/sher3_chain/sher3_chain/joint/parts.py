"""The parts of a record that are read as runs of their own."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array, Mask
from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import clock_beside, find
from sher3_machines.intake.fields import Clock, Column
from sher3_machines.intake.mending.parts import LONGEST_HOLE, SHORTEST, cut
from sher3_machines.intake.mending.stretches import MOST_READINGS, beginning, spread
from sher3_machines.intake.spelling import table_of
from sher3_machines.intake.tables import Tables

from sher3_chain.joint.description import ChainDescription
from sher3_chain.joint.record import STILL


def parts_of_record(
    name: str, tables: Tables, machine: ChainDescription, records: int = 1
) -> tuple[dict[str, Tables], str]:
    """Return the parts of a record by name, and a note; the record itself where it is read whole.

    It is cut where its clock jumps back, and at holes of its clock or of a column; of more readings than an answer
    needs stretches are taken. A repeat is one part, and of more readings its beginning: repeats are held against each
    other from their first sample.

    Args:
        name: of the run.
        tables: its columns.
        machine: whose columns count.
        records: that are judged together.
    """
    columns = columns_of(machine)
    if machine.repeats:
        most = MOST_READINGS // (len(columns) * records)
        whole, note = beginning(name, tables, _stamps(tables, machine.time), most)
        return {name: whole}, note
    parts, note = _cut_at_holes(name, tables, machine)
    most, rows = MOST_READINGS // (len(columns) * records), sum(map(_rows, parts.values()))
    out: dict[str, Tables] = {}
    notes = [note] if note else []
    for part, own in parts.items():
        found, said = spread(part, own, _stamps(own, machine.time), most * _rows(own) // max(rows, 1))
        out |= found
        notes += [said] if said else []
    return out, "; ".join(notes)


def columns_of(machine: ChainDescription) -> list[Column]:
    """Return the columns of a machine's signals."""
    return [c for axis in machine.chain for c in vars(axis.signals).values() if isinstance(c, Column)]


def _cut_at_holes(name: str, tables: Tables, machine: ChainDescription) -> tuple[dict[str, Tables], str]:
    homes = {table_of(column.column) for column in columns_of(machine)}
    clocks = {clock_beside(home, tables, machine.time, name) for home in homes}
    if len(clocks) != 1 or (clock := clocks.pop()) is None:
        return {name: tables}, ""
    try:
        stamps = find(clock, tables, name)
        return cut(name, tables, stamps, _read(name, tables, machine, tables[stamps]))
    except MachineError:
        return {name: tables}, ""  # the reader names what is missing


def _read(name: str, tables: Tables, machine: ChainDescription, stamps: Array) -> Mask:
    """Return the rows (n,) in which any joint has a place and no column a hole: joints are judged together."""
    found = [tables[find(axis.signals.position.column, tables, name)] for axis in machine.chain]
    placed = [np.isfinite(x).any(axis=tuple(range(1, x.ndim))) for x in found if len(x) == len(stamps)]
    read = np.any(placed, axis=0) if placed else np.ones(len(stamps), dtype=bool)
    for x in (tables[find(column.column, tables, name)] for column in columns_of(machine)):
        if x.shape == stamps.shape == (len(stamps),):  # a table of columns by number has no hole of one column
            read &= ~_in_hole(stamps, x)
    return np.asarray(read)


def _in_hole(stamps: Array, x: Array) -> Mask:
    """Return the rows (n,) in a hole of a column (n,), over which it changes, by the periods of its own readings."""
    known = np.flatnonzero(np.isfinite(x) & np.isfinite(stamps))
    out, steps = np.zeros(len(x), dtype=bool), np.diff(stamps[known])
    if len(known) >= SHORTEST:
        moved = np.abs(np.diff(x[known])) > STILL * np.ptp(x[known])
        for i in np.flatnonzero(moved & (steps > LONGEST_HOLE * np.median(steps))):
            out[known[i] + 1 : known[i + 1]] = True
    return out


def _rows(tables: Tables) -> int:
    return max((len(x) for x in tables.values() if x.ndim), default=0)


def _stamps(tables: Tables, clock: Clock) -> dict[str, Array]:
    """Return column -> stamps of its table, or the number of each sample where the clock is a rate."""
    if clock.column is None:
        return {name: np.arange(len(x), dtype=float) for name, x in tables.items() if x.ndim}
    found = {home: tables.get(str(clock_beside(home, tables, clock, ""))) for home in map(table_of, tables)}
    known = {home: t for home, t in found.items() if t is not None and t.ndim == 1 and np.isfinite(t).all()}
    beside = {name: known.get(table_of(name), ()) for name in tables}
    return {name: np.asarray(t) for name, t in beside.items() if tables[name].ndim and len(t) == len(tables[name]) > 0}
