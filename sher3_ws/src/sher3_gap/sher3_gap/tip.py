"""Closure at the tip: the tracked tip against the model run from the set-points, nominal and with the causes added."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import CubicSpline

from sher3_gap.channels import Array, Channel
from sher3_gap.evidence import Evidence
from sher3_gap.quantify import interval_of
from sher3_gap.selffloor import driven_as
from sher3_gap.signals import RunSignals
from sher3_gap.simulator import to_effects
from sher3_gap.verdict import Cause, Interval

NO_TIP_GAP = 1.2
"""Nominal power over floor below which there is nothing at the tip to close."""


def tip_closure(evidence: Evidence, causes: Sequence[Cause]) -> Interval | None:
    """Closure of the free-run tip position; None without a tracker, without set-points, or without a gap at the tip."""
    effects = to_effects(causes, evidence.robot)
    rows = []
    for r, run in enumerate(evidence.runs):
        if run.tracker_position is None or run.reference is None:
            continue
        floor = evidence.floors[r].get(Channel("mechanism", "tip"))
        if floor is None:
            continue
        nominal = tip_error(run, driven_as(run, evidence.robot))
        corrected = tip_error(run, driven_as(run, evidence.robot, effects=effects)) if effects else nominal
        power = float(np.mean(floor[:3] ** 2)) * 3.0
        rows.append([np.mean(np.sum(e**2, axis=1)) / power for e in (nominal, corrected)] + [2.0])
    if not rows:
        return None
    table = np.array(rows)
    if table[:, 0].mean() < NO_TIP_GAP * 2.0:
        return None
    return interval_of(table)


def tip_error(run: RunSignals, twin: RunSignals | None) -> Array:
    """Tracked tip of the run minus that of its twin at the same ticks, (m, 3); a tracker keeps its own time."""
    assert twin is not None and run.tracker_index is not None and twin.tracker_index is not None
    assert run.tracker_position is not None and twin.tracker_position is not None
    ticks = run.tracker_index
    inside = (ticks >= twin.tracker_index[0]) & (ticks <= twin.tracker_index[-1])
    path = CubicSpline(twin.tracker_index, twin.tracker_position)
    return run.tracker_position[inside] - path(ticks[inside])
