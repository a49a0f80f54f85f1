"""An effort many times what a light link needs: it is in another unit, unless the link carries a payload.

A tool of a kilogram and a half on a wrist of 0.4 kg makes twelve times the torque. The joints below feel it too: what
they lack, as a payload on that link, says how much of the wrist's effort is its.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_chain.manipulator.identification.gains import equations, friction_columns
from sher3_chain.manipulator.view import MotionView
from sher3_chain.readings.slip_of_unit import Share, share_in

AT_JOINT = (0.0, 0.0, 0.0)
"""Centre about which the inertia of a payload is reckoned: its weight is what tells it here."""

LOADS = 4
"""Columns of a payload: its mass, and its mass times its centre."""


def slipped(views: Sequence[MotionView], found: Mapping[str, Share]) -> dict[str, Share]:
    """Return joint -> share of the efforts that are in another unit than stated, and that no payload explains.

    Args:
        views: of all records, with the forces of the model in newton metres.
        found: joint with a stated gain -> units of its effort per newton metre.
    """
    off = {name: share for name, share in found.items() if share.slipped}
    others = [name for name in found if name not in off]
    return {name: share for name, share in off.items() if share.value < 1.0 or not carries(views, name, others)}


def carries(views: Sequence[MotionView], joint: str, others: Sequence[str]) -> bool:
    """Return whether a payload on the link of a joint, as other joints feel it, makes its effort one of its unit."""
    model = views[0].model
    link = model.links[model.rows[model.names.index(joint)]]
    columns, target = [], []
    for k, other in enumerate(others):
        for view in views:
            loads = view.payload(link, AT_JOINT).get(other)
            if loads is None or not np.any(loads):
                continue
            row, ok = view.row(other), view.in_motion(view.row(other))
            left = (view.effort[:, row] - view.rigid[:, row])[ok]
            own = np.zeros((len(left), 3 * len(others)))
            own[:, 3 * k : 3 * k + 3] = friction_columns(view, other)[ok]
            scale = float(np.std(left)) or 1.0
            columns.append(np.hstack([loads[ok], own]) / scale)
            target.append(left / scale)
    if not columns:
        return False
    load: Array = np.linalg.lstsq(np.concatenate(columns), np.concatenate(target), rcond=None)[0][:LOADS]
    if load[0] <= 0.0:
        return False
    x, y = equations(views, joint)
    extra = np.concatenate([(v.payload(link, AT_JOINT)[joint] @ load)[v.in_motion(v.row(joint))] for v in views])
    return not share_in(np.column_stack([x[:, 0] + extra, x[:, 1:]]), y).slipped
