"""What a record shows of the true causes of a drawn arm, by a fit that knows where they sit: no diagnosis in it.

MuJoCo's inverse dynamics of the healthy arm leave a force on every joint, which is linear in the sizes of the causes.
All joints are fitted together, since each of them feels the payload; each in units of its own force.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray
from sher3_arms.truth.world import inverse
from sher3_diagnosis.filter import low_pass
from true_structure import ENDS, SPREAD, STILL, not_shown

Array = NDArray[np.float64]
BAND = 20.0
"""Cut-off of the fits, Hz."""


class Motion(NamedTuple):
    """Filtered positions, velocities, accelerations (n, k) and what the model leaves of the forces, (n, k)."""

    q: Array
    v: Array
    a: Array
    left: Array
    period: float


def motion_of(nominal: mujoco.MjModel, qpos: Array, force: Array) -> Motion:
    """Return the motion of a record and what the healthy arm leaves of its forces."""
    period = float(nominal.opt.timestep)
    q = low_pass(qpos, period, BAND)
    v = np.gradient(q, period, axis=0)
    a = np.gradient(v, period, axis=0)
    left = low_pass(force * nominal.actuator_gear[:, 0] - inverse(nominal, q, v, a), period, BAND)
    return Motion(q, v, a, left, period)


def powerless_on(m: Motion, carried: Array, causes: Sequence[tuple[str, int]], named: Sequence[str]) -> set[str]:
    """Return the names of causes that the record does not show.

    Args:
        m: motion, and what the healthy arm leaves.
        carried: (n, k) what a unit of the payload adds.
        causes: kind and joint of each.
        named: what each of them is called.
    """
    n, k = m.q.shape
    top = np.abs(m.v).max(axis=0)
    laws = {"viscous": m.v, "coulomb": np.tanh(m.v / (STILL * top)), "spring": m.q, "rotor": m.a, "payload": carried}
    columns = {f"zero {j}": _at(np.ones_like(m.q), [j]) for j in range(k)}
    for (kind, joint), name in zip(causes, named, strict=True):
        columns[name] = _at(laws[kind], range(k) if kind == "payload" else [joint])
    size = np.maximum(m.left.std(axis=0), 1e-12)
    filtered = {name: (low_pass(x, m.period, BAND) / size) for name, x in columns.items()}
    rubbing = [j for kind, j in causes if kind == "coulomb"]
    ok = np.zeros((n, k), bool)
    ends = max(1, round(ENDS / m.period))
    ok[ends:-ends] = True
    reach = np.ones(2 * int(np.ceil(SPREAD / (BAND * m.period))) + 1)
    for j in rubbing:
        ok[:, j] &= np.convolve(np.abs(m.v[:, j]) < STILL * top[j], reach, "same") < 0.5
    return not_shown({c: x.ravel() for c, x in filtered.items()}, (m.left / size).ravel(), ok.ravel(), set(named))


def _at(x: Array, joints: Sequence[int]) -> Array:
    """Return a column (n, k) at some joints alone."""
    out = np.zeros_like(x)
    out[:, list(joints)] = x[:, list(joints)]
    return out
