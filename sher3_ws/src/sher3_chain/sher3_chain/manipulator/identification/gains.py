"""Sign and scale of a recorded effort, found before causes are looked for: how many of its units a newton metre is.

effort = share * (needed force) + friction, with the inertias of the model taken as true. The gain, the weight and a
payload can then not be told apart, which the notes say. A negative share is an effort recorded with the opposite sign;
where the share is not told, the sign is that by which friction takes work and does not give it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_chain.chain.view import BUILDS_UP
from sher3_chain.manipulator.view import MotionView
from sher3_chain.readings.slip_of_unit import Share, share_in


def share_of(views: Sequence[MotionView], joint: str) -> Share:
    """Return the share of a joint, beside Coulomb and viscous friction and a constant force.

    Args:
        views: of all records, with the forces of the model in newton metres.
        joint: whose effort is looked at.
    """
    return share_in(*equations(views, joint))


def equations(views: Sequence[MotionView], joint: str) -> tuple[Array, Array]:
    """Return columns (n, 4): needed force, velocity, direction, one; and the recorded effort (n,)."""
    rows, target = [], []
    for view in views:
        row = view.row(joint)
        ok = view.in_motion(row)
        rows.append(np.column_stack([view.rigid[:, row], friction_columns(view, joint)])[ok])
        target.append(view.effort[ok, row])
    return np.concatenate(rows), np.concatenate(target)


def friction_columns(view: MotionView, joint: str) -> Array:
    """Return velocity, direction and one on the residual grid, (g, 3)."""
    row = view.row(joint)
    direction = view.run.to_grid(view.sliding(row, BUILDS_UP * view.lead(joint))[:, None])[:, 0]
    return np.column_stack([view.velocity[:, row], direction, np.ones(len(direction))])


def backwards(found: Mapping[str, Share], stated: Collection[str]) -> tuple[str, ...]:
    """Return the joints whose efforts are to be turned.

    One controller counts all its efforts alike: where some are surely of the opposite sign and none is surely right,
    those are turned too whose sign nothing tells.

    Args:
        found: joint -> share of its effort.
        stated: joints whose gain is stated.
    """
    senses = {name: share.sense(name in stated) for name, share in found.items()}
    all_alike = -1 in senses.values() and 1 not in senses.values()
    return tuple(name for name, sense in senses.items() if sense < 0 or all_alike)
