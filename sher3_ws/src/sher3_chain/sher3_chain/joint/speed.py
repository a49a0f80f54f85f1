"""A place that was recorded as a velocity: a tachometer, or a drive that logs its speed alone."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import IN_HEADER, find
from sher3_machines.intake.fields import VELOCITIES, Clock, Column
from sher3_machines.intake.tables import Tables
from sher3_machines.intake.units import spelled


def is_speed(column: Column, tables: Tables, run: str) -> bool:
    """Return whether a column is in a unit of velocity, as the description or its header says; raises MachineError."""
    match = IN_HEADER.fullmatch(find(column.column, tables, run))
    return (column.unit or (spelled(match["unit"]) if match else "")) in VELOCITIES


ALTERNATING = -0.5
"""Correlation of a speed with that of the row before, below which rows are no instants: noise has -0.5 at the least."""


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
