"""Residuals and floors of a load cell; every eighth reading is held out in turn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Residual
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.whitened import Whitened
from sher3_machines.thresholds import BLOCKS

from sher3_static.cell.description import CellDescription
from sher3_static.cell.record import SAME, CellRun, unloading
from sher3_static.cell.view import ForcesView

READING = Channel("sensing", "load_cell")
"""The one channel of a cell."""
REPEATED = 8
"""Repeats from which they tell the scatter of a reading by themselves: a third of it is then not known, no more."""
RESOLVED = 1e-6
"""Smallest floor as a share of the range: readings that agree to the last digit are limited by their rounding."""


def gather_cell(description: CellDescription, runs: Sequence[CellRun]) -> Evidence:
    """Compute the residuals of all readings."""
    applied, reading = (np.concatenate([getattr(run, name) for run in runs]) for name in ("applied", "reading"))
    side = np.concatenate([unloading(run.applied) for run in runs])
    warm = np.nan_to_num(np.concatenate([run.temperature - run.temperature[0] for run in runs]))
    view = ForcesView(applied, side, warm)
    floor = np.array([description.noise or max(scatter(view, reading), RESOLVED * float(np.ptp(applied)))])
    fold = np.arange(len(applied)) % BLOCKS
    residual = (reading - applied)[:, None]
    data = Whitened(
        [view] * BLOCKS, [{READING: Residual(residual, fold == k)} for k in range(BLOCKS)], [{READING: floor}] * BLOCKS
    )
    return Evidence(
        excitations=[view.excitation] * BLOCKS,
        data=data,
        units={READING: description.unit},
        places={"load_cell": (READING.actuator,)},
        rotary=frozenset({READING.actuator} if description.measures == "torque" else ()),
    )


def scatter(view: ForcesView, reading: Array) -> float:
    """Return the standard deviation of a reading beyond a wandering zero.

    What differs at one force reached from one side, where forces were repeated; else what no curve of third order in
    the force, of its own for each direction, explains.
    """
    drift = np.column_stack([view.elapsed, view.warmth])
    force = np.round(view.share / SAME)
    cell = np.unique(np.column_stack([force, view.unloading]), axis=0, return_inverse=True)[1].ravel()
    same = np.eye(cell.max() + 1)[cell]
    u, bow = view.share, view.share * (1.0 - view.share) * view.unloading
    smooth = np.column_stack([np.ones(len(u)), u, u**2, u**3, bow, bow * u])
    for x in (np.hstack([same, drift]), np.hstack([smooth, drift])):
        free = len(reading) - int(np.linalg.matrix_rank(x))
        if free >= REPEATED:
            break
    left = reading - x @ np.linalg.lstsq(x, reading, rcond=None)[0]
    return float(np.sqrt(np.sum(left**2) / max(free, 1)))
