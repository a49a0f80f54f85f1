"""Records of a force sensor, with the checks that refuse readings no answer could rest on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import pick_beside
from sher3_machines.intake.poses import together, turns_of
from sher3_machines.intake.tables import Tables

from sher3_static.sensor.description import SensorDescription

LEAST_ROWS = 20
"""Readings that a record must have: ten numbers of a linear sensor, twice."""
MOST_ROWS = 5000
"""Readings that are used; of more every n-th counts, since neighbours tell the same."""
SPREAD = 0.05
"""Smallest over largest singular value of the directions of gravity, below which one of them was hardly taken."""


@dataclass(frozen=True)
class SensorRun:
    """One record.

    Attributes:
        name: of its file.
        wrench: (n, 6) readings, N and N m.
        turn: (n, 3, 3) sensor in the upright frame.
        temperature: (n,) deg C; nan where it was not recorded.
        notes: what was done to the data.
    """

    name: str
    wrench: Array
    turn: Array
    temperature: Array
    notes: Sequence[str] = ()


def sensor_run(name: str, tables: Tables, machine: SensorDescription) -> SensorRun:
    """Check the columns of a file and bring them to SI units.

    Raises:
        MachineError: a column is missing, readings are too few, dead or of another length, or orientations too alike.
    """
    force, torque = together(machine.force, tables, name, 3), together(machine.torque, tables, name, 3)
    turn = turns_of(machine.orientation, tables, name).as_matrix()
    lengths = {"force": len(force), "torque": len(torque), "orientation": len(turn)}
    if len(set(lengths.values())) > 1:
        remedy = "name columns of one table, or resample them to one clock"
        raise MachineError(f"{name}: columns differ in length", value=lengths, remedy=remedy)
    if len(force) < LEAST_ROWS:
        remedy = "record more orientations"
        raise MachineError(f"{name}: too few readings", value=len(force), limit=LEAST_ROWS, remedy=remedy)
    wrench = np.hstack([force, torque])
    for i, label in enumerate(("fx", "fy", "fz", "tx", "ty", "tz")):
        if np.ptp(wrench[:, i]) == 0.0:
            remedy = "check whether this channel is connected"
            raise MachineError(f"{name}: {label} never changes", value=f"{wrench[0, i]:.6g}", remedy=remedy)
    directions = np.linalg.svd(turn[:, 2, :] - turn[:, 2, :].mean(axis=0), compute_uv=False)
    if directions[2] < SPREAD * directions[0]:
        raise MachineError(
            f"{name}: orientations are too alike to tell weight from bias",
            value=f"{directions[2] / max(directions[0], 1e-12):.2g}",
            limit=f"{SPREAD} of the widest direction",
            remedy="turn the sensor about two horizontal axes, also upside down",
        )
    warm = np.full(len(force), np.nan)
    if machine.temperature is not None:
        warm = pick_beside((len(force),), machine.temperature, tables, name)
    step = -(-len(force) // MOST_ROWS)
    notes = [f"{name}: every {step}th of {len(force)} readings is used"] if step > 1 else []
    return SensorRun(name, wrench[::step], turn[::step], warm[::step], notes)
