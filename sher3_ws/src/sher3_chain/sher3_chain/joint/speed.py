"""A place that was recorded as a velocity: a tachometer, or a drive that logs its speed alone."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.intake.columns import IN_HEADER, find
from sher3_machines.intake.fields import VELOCITIES, Clock, Column
from sher3_machines.intake.tables import Tables
from sher3_machines.intake.units import spelled


def is_speed(column: Column, tables: Tables, run: str) -> bool:
    """Return whether a column is in a unit of velocity, as the description or its header says; raises MachineError."""
    match = IN_HEADER.fullmatch(find(column.column, tables, run))
    return (column.unit or (spelled(match["unit"]) if match else "")) in VELOCITIES


def integrated(stamps: Array | None, x: Array, clock: Clock) -> Array:
    """Return the place (n,) that a velocity (n,), m/s or rad/s, adds up to from zero on (trapezes)."""
    steps = np.diff(stamps) if stamps is not None else np.full(len(x) - 1, 1.0 / (clock.rate or 1.0))
    return np.concatenate([[0.0], np.cumsum(0.5 * (x[1:] + x[:-1]) * steps)])
