"""An unknown mass from the force balance: least squares on acceleration and the usual resisting forces together.

Inverse-dynamics identification (Gautier, Janot): force - weight = M a + Fv v + Fc sign(v) + offset, on filtered,
decimated data. Which of the last three are there is settled by the held-out loss over blocks of the record.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from sher3_gap.channels import Array
from sher3_gap.fitting import solve
from sher3_gap.machines.axis_view import AxisView
from sher3_gap.machines.errors import MachineError
from sher3_gap.residuals import settled

BLOCKS = 8
SLOW = 0.2
"""Share of the rms speed below which samples are left out: around a reversal dry friction is no sign function."""
LEAST_EXCITED = 2.0
"""Mass over its standard error that an identified mass must have."""


def identify_mass(views: Sequence[AxisView]) -> tuple[float, tuple[float, float]]:
    """Mass and its 95 % interval (block jackknife); `views` have a nominal mass of zero.

    Raises:
        MachineError: the record does not accelerate enough to tell a mass.
    """
    rows, target = zip(*(_equations(v) for v in views), strict=True)
    x, y = np.concatenate(rows), np.concatenate(target)
    block = np.arange(len(y)) * BLOCKS // max(len(y), 1)
    choices = [(0, *c) for n in range(4) for c in combinations((1, 2, 3), n)]
    losses = [_held_out(x[:, c], y, block)[0] for c in choices]
    best = choices[int(np.argmin(losses))]
    _, draws = _held_out(x[:, best], y, block)
    mass = float(solve(x[:, best].T @ x[:, best], x[:, best].T @ y)[0])
    error = float(np.sqrt((BLOCKS - 1) / BLOCKS * np.sum((draws - draws.mean()) ** 2)))
    axis = views[0].axis.name
    if not mass > LEAST_EXCITED * error:
        raise MachineError(
            f"axis {axis}: the record does not tell its mass", value=f"{mass:.3g} +- {error:.2g}", remedy="state `mass`"
        )
    return mass, (mass - 2.3 * error, mass + 2.3 * error)


def _equations(view: AxisView) -> tuple[Array, Array]:
    run = view.run
    speed = np.abs(view.velocity[:, 0])
    ok = run.inner & view.free & settled(view.moving, 1)
    ok &= speed > SLOW * np.sqrt(np.mean(speed[ok] ** 2)) if ok.any() else ok
    z = run.to_grid(view.sliding(0, 2.5e-3 * view.robot.actuators[0].lead)[:, None])[:, 0]
    assert run.effort is not None
    y = run.to_grid(run.effort)[:, 0] - view.inertial[:, 0]
    x = np.column_stack([run.to_grid(run.acceleration)[:, 0], view.velocity[:, 0], z, np.ones(len(y))])
    return x[ok], y[ok]


def _held_out(x: Array, y: Array, block: NDArray[np.int64]) -> tuple[float, Array]:
    """Loss of every block under the others' coefficients, and the mass without each block."""
    loss, draws = 0.0, []
    for k in range(BLOCKS):
        out = block == k
        beta = solve(x[~out].T @ x[~out], x[~out].T @ y[~out])
        loss += float(np.sum((y[out] - x[out] @ beta) ** 2))
        draws.append(beta[0])
    return loss, np.array(draws)
