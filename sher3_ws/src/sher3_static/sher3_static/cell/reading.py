"""Readings of a load cell: the checks that refuse a record no answer could rest on, and their scatter."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_effects.table_view import CellView
from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import pick, pick_beside
from sher3_machines.intake.tables import Tables

from sher3_static.cell.description import CellDescription
from sher3_static.readings import (
    Labels,
    Readings,
    as_weight,
    enough,
    one_hot,
    same,
    scatter_beyond,
    temperature,
    thinned,
)

LEAST_ROWS = 12
"""Readings that all records must have: six forces, going and coming."""
MORE_ROWS = "record more readings: six forces with growing and with falling load are enough"
LEAST_FORCES = 3
"""Different forces that it must have: two tell no more than a line."""
SLIPPED = 3.0
"""Factor between reading and force, either way, from which the `factor` is wrong: sensitivities are off by less."""
SAME = 1e-3
"""Share of the range by which two forces must differ to be a change of the load."""
REPEATED = 8
"""Repeats from which they tell the scatter of a reading by themselves: a third of it is then not known, no more."""


def read_cell(name: str, tables: Tables, description: CellDescription) -> Readings:
    """Check the columns of a file and bring them to SI units: `applied`, `reading`, `temperature`.

    Raises:
        MachineError: a column is missing, too few forces, a dead channel, or a factor that is far off.
    """
    applied = pick(description.applied, tables, name) * as_weight(description.applied)
    reading = pick_beside((len(applied),), description.reading, tables, name) * as_weight(description.reading)
    warm = temperature(description.temperature, len(applied), tables, name)
    span = float(np.ptp(applied))
    forces = len(np.unique(np.round(applied / (SAME * span)))) if span else 1
    enough(f"{name}: too few different forces", forces, LEAST_FORCES, "apply more different forces")
    _check_reading(name, applied, reading, description)
    return thinned(name, {"applied": applied, "reading": reading, "temperature": warm})


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


def scatter(view: CellView, reading: Array, run: Labels) -> float:
    """Return the standard deviation of a reading (n,), in its unit, beyond a zero that wanders and differs by run.

    What differs at one force reached from one side, where forces were repeated; else what no curve of third order in
    the force, of its own for each direction, explains.
    """
    drift = np.column_stack([view.elapsed, view.warmth, one_hot(run)])
    u, bow = view.share, view.share * (1.0 - view.share) * view.unloading
    smooth = np.column_stack([np.ones(len(u)), u, u**2, u**3, bow, bow * u])
    repeated = same(np.round(u / SAME), view.unloading)
    found, free = scatter_beyond(np.hstack([repeated, drift]), reading[:, None])
    return float((found if free >= REPEATED else scatter_beyond(np.hstack([smooth, drift]), reading[:, None])[0])[0])
