"""Forces and speeds of a chain that a log has in a field without a sign."""

from __future__ import annotations

from sher3_machines.intake.columns import find
from sher3_machines.intake.mending.fields import signed
from sher3_machines.intake.tables import Tables

from sher3_chain.joint.description import ChainDescription

SIGNED = ("command", "effort", "nominal_effort", "applied", "velocity")
"""Signals that may be below zero and have no counter: places are joined where theirs starts again."""


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
