"""Records of a load cell, with the checks that refuse readings no answer could rest on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import pick, pick_beside
from sher3_machines.intake.tables import Tables

from sher3_static.cell.description import CellDescription

LEAST_ROWS = 12
"""Readings that a record must have: six forces, going and coming."""
LEAST_FORCES = 3
"""Different forces that it must have: two tell no more than a line."""
MOST_ROWS = 5000
"""Readings that are used; of more every n-th counts, since neighbours tell the same."""
SLIPPED = 3.0
"""Factor between reading and force, either way, from which the `factor` is wrong: sensitivities are off by less."""
SAME = 1e-3
"""Share of the range by which two forces must differ to be a change of the load."""


@dataclass(frozen=True)
class CellRun:
    """One record, SI units.

    Attributes:
        name: of its file.
        applied, reading: (n,) known force, and what the cell read.
        temperature: (n,) deg C; nan where it was not recorded.
        notes: what was done to the data.
    """

    name: str
    applied: Array
    reading: Array
    temperature: Array
    notes: Sequence[str] = ()


def cell_run(name: str, tables: Tables, description: CellDescription) -> CellRun:
    """Check the columns of a file and bring them to SI units.

    Raises:
        MachineError: a column is missing, too few readings or forces, a dead channel, or a factor that is far off.
    """
    applied = pick(description.applied, tables, name)
    reading = pick_beside((len(applied),), description.reading, tables, name)
    warm = np.full(len(applied), np.nan)
    if description.temperature is not None:
        warm = pick_beside((len(applied),), description.temperature, tables, name)
    if len(applied) < LEAST_ROWS:
        remedy = "record more readings: six forces with growing and with falling load are enough"
        raise MachineError(f"{name}: too few readings", value=len(applied), limit=LEAST_ROWS, remedy=remedy)
    span = float(np.ptp(applied))
    forces = len(np.unique(np.round(applied / (SAME * span)))) if span else 1
    if forces < LEAST_FORCES:
        remedy = "apply more different forces"
        raise MachineError(f"{name}: too few different forces", value=forces, limit=LEAST_FORCES, remedy=remedy)
    _check_reading(name, applied, reading, description)
    step = -(-len(applied) // MOST_ROWS)
    notes = [f"{name}: every {step}th of {len(applied)} readings is used"] if step > 1 else []
    return CellRun(name, applied[::step], reading[::step], warm[::step], notes)


def _check_reading(name: str, applied: Array, reading: Array, description: CellDescription) -> None:
    column, about = description.reading.column, applied - applied.mean()
    ratio = float(about @ reading / (about @ about))
    if not np.ptp(reading):
        remedy = "connect it, or name another column"
        raise MachineError(f"{name}: {column} never changes: a dead channel", value=f"{reading[0]:.4g}", remedy=remedy)
    if ratio < 0.0:
        remedy = "give `factor` the other sign in the description"
        raise MachineError(f"{name}: {column} falls as the force grows", value=f"{ratio:.4g}", remedy=remedy)
    if not 1.0 / SLIPPED < ratio < SLIPPED:
        unit = f"{description.unit} per SI unit of the reading, such as N per V"
        raise MachineError(
            f"{name}: {column} changes by another size than the force",
            value=f"{ratio:.4g} times",
            limit=f"{1.0 / SLIPPED:.2g} .. {SLIPPED:g}",
            remedy=f"correct unit and `factor` in the description: {unit}; {description.reading.factor / ratio:.4g} "
            "would make them alike",
        )


def unloading(applied: Array) -> Array:
    """Return (n,) 1 where a force was reached from a larger one, 0 elsewhere; one that stays keeps its side."""
    out, least = np.zeros(len(applied)), SAME * float(np.ptp(applied))
    for i in range(1, len(applied)):
        step = applied[i] - applied[i - 1]
        out[i] = out[i - 1] if abs(step) < least else float(step < 0.0)
    return out
