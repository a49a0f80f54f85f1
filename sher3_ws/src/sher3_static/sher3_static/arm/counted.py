"""How a controller counts the joints of an arm: in the other sense than the model, or with the joint before it.

A drawing and a controller often disagree on which way a joint turns. The forearm of many industrial arms is counted
against the floor: its reading is the turn of its own joint and that of the upper arm. Neither is an error of the arm.
So every sense and at most one such sum are tried where the tip is off by a share of its travel, and the way whose
frames fit far better is taken.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError

from sher3_static.arm.frames import fitted_view, started_view
from sher3_static.arm.kinematics import Arm, postures
from sher3_static.arm.sight import Sight
from sher3_static.arm.view import ArmView
from sher3_static.readings import Labels

POSTURES = 150
"""Postures at which the ways to count are compared."""
WRONG = 0.02
"""Error of the tip over its travel from which other ways to count are tried: the zeros and lengths of arms that are
built make less than half of it."""
CLEARER = 0.1
"""Share of the error that another way to count may leave: a wrong sense makes the tip miss by its travel, and no zero
that is off does."""
ALIKE = 1.1
"""Errors within this ratio are alike: of two such ways to count the one that changes fewer joints is taken."""
NEAR = 3.0
"""Errors at the linear start of the frames within this ratio may change places when the frames are fitted."""
PARALLEL = 1e-3
"""Largest sine between the axes of two joints whose turns add up."""


def counted_view(
    arm: Arm, recorded: Array, measured: Array, run: Labels, floor: Array, sight: Sight
) -> tuple[ArmView, Array]:
    """Return nominal postures with their frames, and the matrix (k, k) of -1, 0 and 1 that takes out how they count.

    Args:
        arm: nominal.
        recorded: (n, k) joint positions as the controller counts them, rad or m.
        measured: readings of the instrument.
        run: (n,) number of the run.
        floor: (d,) standard deviation of a reading.
        sight: what the instrument sees.

    Raises:
        MachineError: the postures do not tell the frames.
    """
    some = np.linspace(0, len(recorded) - 1, min(POSTURES, len(recorded))).astype(int)

    def missed(counts: Array, fitted: bool) -> float:
        q = recorded[some] @ counts.T
        try:
            if fitted:
                return _off(fitted_view(arm, q, measured[some], run[some], floor, sight), measured[some])
            return _off(started_view(arm, q, measured[some], run[some], sight), measured[some])
        except (MachineError, np.linalg.LinAlgError):
            return np.inf

    stated = np.eye(len(arm.names))
    view = fitted_view(arm, recorded, measured, run, floor, sight)
    travel = view.postures.tip[:, :3, 3].std(axis=0).max()
    if (before := _off(view, measured)) < WRONG * travel:
        return view, stated
    ways = list(_ways(arm))
    start = np.array([missed(way, fitted=False) for way in ways])
    ways = [ways[i] for i in np.flatnonzero(start <= NEAR * start.min())]
    left = np.array([missed(way, fitted=True) for way in ways])
    alike = np.flatnonzero(left <= ALIKE * left.min())
    best = min(alike, key=lambda i: (np.abs(ways[i] - stated).sum(), left[i]))
    if left[best] > CLEARER * before:
        return view, stated
    return fitted_view(arm, recorded @ ways[best].T, measured, run, floor, sight), ways[best]


def in_words(arm: Arm, counts: Array) -> list[str]:
    """Return what is to be said of joints that are counted otherwise than the model has them, (k, k)."""
    names = np.array(arm.names)
    against, sums = names[np.diag(counts) < 0.0], np.argwhere(counts - np.diag(np.diag(counts)))
    said = [f"{names[i]} is recorded with the turn of {names[j]} in it: taken out in all runs" for i, j in sums]
    if len(against):
        said.append(f"{', '.join(against)}: recorded in the other sense than the model has; turned in all runs")
    return said


def _off(view: ArmView, measured: Array) -> float:
    """Return the error of the tip, or of its length, m rms."""
    return float(np.sqrt(np.mean(view.sight.error(view.pose, measured)[:, :3] ** 2)))


def _ways(arm: Arm) -> Iterator[Array]:
    """Yield every matrix of senses, without a sum and with one of two neighbours whose axes are parallel."""
    k = len(arm.names)
    axes = postures(arm, np.zeros((1, k))).axes[0]
    turning = [name in arm.turning for name in arm.names]
    beside = np.linalg.norm(np.cross(axes[1:], axes[:-1]), axis=1) < PARALLEL
    sums = [np.zeros((k, k))]
    for i in range(1, k):
        if beside[i - 1] and turning[i] and turning[i - 1]:
            sums += [sign * np.eye(k, k, -1) * (np.arange(k) == i)[:, None] for sign in (1.0, -1.0)]
    for senses, more in product(product((1.0, -1.0), repeat=k), sums):
        yield np.diag(senses) + more
