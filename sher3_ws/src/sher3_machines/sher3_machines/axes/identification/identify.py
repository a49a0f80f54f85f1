"""An unknown mass from the force balance: least squares on acceleration and the usual resisting forces together.

Inverse-dynamics identification (Gautier and Khalil; Janot et al.): force - weight = M a + Fv v + Fc sign(v) + offset,
on filtered, decimated data. The held-out loss over blocks of the record settles which of the last three are there.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from sher3_diagnosis.channel import Array
from sher3_diagnosis.fit.fitting import solve
from sher3_diagnosis.thresholds import JACKKNIFE

from sher3_machines.axes.view import AxisView
from sher3_machines.errors import MachineError
from sher3_machines.thresholds import BLOCKS, LEAST_EXCITED, NOISE_SHARE, SLOW

RESISTING = (1, 2, 3)
"""Columns of the equations that may be left out: viscous, dry friction, offset; column 0 is the acceleration."""
DAHL_SHARE = 2.5e-3
"""Displacement over which dry friction builds up, in shares of the lead: the middle one that the effects search."""


def identify_mass(views: Sequence[AxisView]) -> tuple[float, tuple[float, float]]:
    """Return a mass and its 95 % interval from a jackknife over blocks and the noise of the encoder, kg or kg m^2.

    Args:
        views: of all records; their nominal mass is zero.

    Raises:
        MachineError: the records do not accelerate enough to tell a mass.
    """
    rows, target = zip(*(_equations(view) for view in views), strict=True)
    x, y = np.concatenate(rows), np.concatenate(target)
    block = np.arange(len(y)) * BLOCKS // max(len(y), 1)
    choices = [(0, *chosen) for n in range(len(RESISTING) + 1) for chosen in combinations(RESISTING, n)]
    losses = [_held_out(x[:, columns], y, block)[0] for columns in choices]
    used = x[:, choices[int(np.argmin(losses))]]
    _, draws = _held_out(used, y, block)
    mass = float(solve(used.T @ used, used.T @ y)[0])
    error = float(np.sqrt((BLOCKS - 1) / BLOCKS * np.sum((draws - draws.mean()) ** 2)))
    if not mass > LEAST_EXCITED * error:
        wrong = mass < -LEAST_EXCITED * error
        what = "its mass comes out below zero: the model is wrong" if wrong else "the record does not tell its mass"
        raise MachineError(
            f"axis {views[0].described.name}: {what}",
            value=f"{mass:.3g} +- {error:.2g}",
            limit=f"{LEAST_EXCITED:g} standard errors above 0",
            remedy="check sign and gain of the force, and weight" if wrong else "state `mass`",
        )
    half = JACKKNIFE * error + NOISE_SHARE * mass
    return mass, (mass - half, mass + half)


def _equations(view: AxisView) -> tuple[Array, Array]:
    """Columns (n, 4) acceleration, velocity, direction, one; and the force (n,) beyond the nominal one."""
    run, site = view.run, view.described.name
    speed = np.abs(view.velocity[:, 0])
    ok = view.in_motion
    if ok.any():
        ok = ok & (speed > SLOW * np.sqrt(np.mean(speed[ok] ** 2)))
    direction = run.to_grid(view.sliding(0, DAHL_SHARE * view.lead(site))[:, None])[:, 0]
    assert run.effort is not None
    y = run.to_grid(run.effort)[:, 0] - view.inertial[:, 0]
    x = np.column_stack([run.to_grid(run.acceleration)[:, 0], view.velocity[:, 0], direction, np.ones(len(y))])
    return x[ok], y[ok]


def _held_out(x: Array, y: Array, block: NDArray[np.int64]) -> tuple[float, Array]:
    """Loss of every block under the others' coefficients, and the mass without each block, (BLOCKS,)."""
    loss, draws = 0.0, []
    for k in range(BLOCKS):
        out = block == k
        beta = solve(x[~out].T @ x[~out], x[~out].T @ y[~out])
        loss += float(np.sum((y[out] - x[out] @ beta) ** 2))
        draws.append(beta[0])
    return loss, np.array(draws)
