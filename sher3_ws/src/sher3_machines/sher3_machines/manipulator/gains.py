"""What the data say of an effort before causes are looked for: its sign, and how many of its units a newton metre is.

effort = share * (needed force) + friction, with the inertias of the model taken as true. The gain, the weight and a
payload can then not be told apart, which the notes say. A negative share is an effort recorded with the opposite sign;
where the share is not told, the sign is that by which friction takes work and does not give it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.fit.fitting import solve
from sher3_diagnosis.thresholds import JACKKNIFE

from sher3_machines.manipulator.view import MotionView
from sher3_machines.thresholds import BLOCKS, LEAST_EXCITED, SLIPPED, SURELY

DAHL_SHARE = 2.5e-3
"""Displacement over which dry friction builds up, in shares of the lead: the middle one that the effects search."""

WRONG_SIGN = 2.0
"""Factor by which the share of a stated gain may be off minus one where its sign alone is wrong."""


class Share(NamedTuple):
    """Units of the recorded effort per newton metre; 0 where the motion does not tell it.

    Attributes:
        value: as found; negative where the effort was recorded with the opposite sign.
        error: its standard error, from a jackknife over blocks.
        backwards: whether the effort was recorded with the opposite sign.
    """

    value: float
    error: float
    backwards: bool

    def turned(self) -> Share:
        """Return the share of the effort with its sign put right."""
        return Share(abs(self.value), self.error, self.backwards)

    def opposite(self, stated: bool) -> bool:
        """Return whether the sign is to be turned.

        With a stated gain a wrong sign alone makes the share about minus one; another one below zero is a force that
        the model lacks, such as that of a payload on a light joint.
        """
        return self.backwards and (not (stated and self.told) or 1.0 / WRONG_SIGN < -self.value < WRONG_SIGN)

    @property
    def slipped(self) -> bool:
        """Whether an effort with a stated gain is so surely in another scale that its unit is wrong and no drive."""
        size = abs(self.value)
        return self.told and size > SURELY * self.error and not 1.0 / SLIPPED < size < SLIPPED

    @property
    def told(self) -> bool:
        """Whether the motion tells it."""
        return self.value != 0.0

    @property
    def interval(self) -> tuple[float, float]:
        """Interval of 95 %."""
        return self.value - JACKKNIFE * self.error, self.value + JACKKNIFE * self.error


def share_of(views: Sequence[MotionView], joint: str) -> Share:
    """Return the share of a joint, beside Coulomb and viscous friction and a constant force.

    Args:
        views: of all records, with the forces of the model in newton metres.
        joint: whose effort is looked at.
    """
    x, y = _equations(views, joint)
    if len(y) < BLOCKS * x.shape[1]:
        return Share(0.0, np.inf, False)
    draws, found = _left_out(x, y), solve(x.T @ x, x.T @ y)
    error = _jackknife(draws[:, 0])
    told = abs(float(found[0])) > LEAST_EXCITED * error
    speed = x[:, 1]
    lost = draws[:, 1] * (speed @ speed) + draws[:, 2] * (speed @ x[:, 2])
    gives = bool(lost.mean() < -LEAST_EXCITED * _jackknife(lost))
    return Share(float(found[0]) if told else 0.0, error, bool(found[0] < 0.0) if told else gives)


def _jackknife(draws: Array) -> float:
    """Standard error of a value from its values without each block, (BLOCKS,)."""
    return float(np.sqrt((BLOCKS - 1) / BLOCKS * np.sum((draws - draws.mean()) ** 2)))


def _left_out(x: Array, y: Array) -> Array:
    """Coefficients without each block, (BLOCKS, 4)."""
    block = np.arange(len(y)) * BLOCKS // len(y)
    kept = [block != k for k in range(BLOCKS)]
    return np.array([solve(x[k].T @ x[k], x[k].T @ y[k]) for k in kept])


def _equations(views: Sequence[MotionView], joint: str) -> tuple[Array, Array]:
    """Columns (n, 4): needed force, velocity, direction, one; and the recorded effort (n,)."""
    rows, target = [], []
    for view in views:
        run, row = view.run, view.row(joint)
        ok = view.in_motion(row)
        assert run.effort is not None
        rows.append(np.column_stack([view.rigid[:, row], friction_columns(view, joint)])[ok])
        target.append(run.to_grid(run.effort)[ok, row])
    return np.concatenate(rows), np.concatenate(target)


def friction_columns(view: MotionView, joint: str) -> Array:
    """Return velocity, direction and one on the residual grid, (g, 3)."""
    row = view.row(joint)
    direction = view.run.to_grid(view.sliding(row, DAHL_SHARE * view.lead(joint))[:, None])[:, 0]
    return np.column_stack([view.velocity[:, row], direction, np.ones(len(direction))])
