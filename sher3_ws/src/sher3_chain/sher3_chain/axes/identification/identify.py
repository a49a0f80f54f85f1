"""An unknown mass from the force balance: least squares on acceleration and the usual resisting forces together.

Inverse-dynamics identification (Gautier and Khalil; Janot et al.): force - weight = M a + Fv v + Fc sign(v) + offset,
on filtered, decimated data. The held-out loss over blocks of the record settles which of the last three are there.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.fit.fitting import solve
from sher3_diagnosis.quantify.jackknife import standard_error
from sher3_diagnosis.thresholds import JACKKNIFE
from sher3_machines.errors import MachineError
from sher3_machines.thresholds import BLOCKS

from sher3_chain.axes.view import AxisView
from sher3_chain.floors.innovation import white_behind
from sher3_chain.thresholds import LEAST_EXCITED, NOISE_SHARE

LEFT = 1e-3
"""Share of the force's power that must be left without them."""
BY_PLACE = (4, 5)
"""Columns of the position."""
BEHIND = 6
"""Column of what a second encoder accelerates beyond the first."""
RESISTING = ((1,), (2,), (3,), BY_PLACE, (BEHIND,))
"""Columns that may be left out: viscous, dry friction, offset, force by position; column 0 is the acceleration."""
MARKED = 0.8
"""Share of the held-out loss that forces by position must leave at most: on one sine they are the acceleration."""
CHOICES = [
    [0, *(k for columns in group for k in columns)]
    for n in range(len(RESISTING) + 1)
    for group in combinations(RESISTING, n)
]
"""Every choice of columns."""
COLUMNS = 1 + sum(map(len, RESISTING))
"""Number of columns."""
OTHERS = 1.0 - np.eye(BLOCKS)
"""Of each block all others."""


def identify_mass(views: Sequence[AxisView]) -> tuple[float, tuple[float, float]]:
    """Return a mass and its 95 % interval from a jackknife over blocks and the noise of the encoder, kg or kg m^2.

    Args:
        views: of all records; their nominal mass is zero.

    Raises:
        MachineError: the records do not accelerate enough to tell a mass.
    """
    x, y = _rows(views)
    if len(y) < BLOCKS:
        raise MachineError(
            f"axis {views[0].described.name}: no sample is left in which it moves under a known force",
            value=f"{len(y)} samples",
            limit=f"at least {BLOCKS}",
            remedy="record it in motion under several forces, or state `mass`",
        )
    blocks = _blocks(x, y)
    _, columns = _best(blocks)
    used = x[:, columns]
    noises = noise_of_columns(views)[columns]
    noise = min(NOISE_SHARE, float(noises[0]) / float(np.mean(used[:, 0] ** 2) or np.inf))
    _, draws = _held_out(blocks, _others(blocks), _chosen([columns]), noise)
    beta = solve(_relieved(used, noise), used.T @ y)
    mass, error = float(beta[0]), float(standard_error(draws[:, 0]))
    hidden = _hidden(used, noises, beta)
    if not mass > LEAST_EXCITED * (error + hidden):
        wrong = mass < -LEAST_EXCITED * (error + hidden)
        what = "its mass comes out below zero: the model is wrong" if wrong else "the record does not tell its mass"
        raise MachineError(
            f"axis {views[0].described.name}: {what}",
            value=f"{mass:.3g} +- {error + hidden:.2g}",
            limit=f"{LEAST_EXCITED:g} standard errors above 0",
            remedy="check sign and gain of the force, and weight" if wrong else "state `mass`",
        )
    half = JACKKNIFE * error + 2.0 * max(NOISE_SHARE * mass, hidden)  # what is taken off is known to as much again
    return mass, (mass - half, mass + half)


def noise_of_columns(views: Sequence[AxisView]) -> Array:
    """Return the mean square (7,) of the encoder's noise in every column: it is in acceleration and velocity."""
    _, pace, bend = np.transpose([view.noise * np.array(white_behind(view.run)) for view in views])
    return np.array([np.mean(bend**2), np.mean(pace**2), *np.zeros(COLUMNS - 2)])


def _hidden(x: Array, noise: Array, beta: Array) -> float:
    """Return by how much noise in the columns (n, p) may make the first of their coefficients (p,) wrong.

    Least squares on noisy columns are off by (X'X)^-1 n diag(noise) beta to first order (Fuller 1987, Measurement Error
    Models, section 1.1); their parts are taken to add up.

    Args:
        x: columns of the force balance.
        noise: mean square in each of them, (p,).
        beta: their coefficients.
    """
    inverse = np.linalg.pinv(x.T @ x, hermitian=True)[0]
    return float(np.sum(np.abs(inverse * len(x) * noise * beta)))


def _relieved(x: Array, noise: float) -> Array:
    """Return the normal matrix (p, p) without what the noise adds to the power of the acceleration, its first column.

    Least squares on a noisy regressor give too small a coefficient (attenuation); the more so, the more of the
    acceleration the other columns can stand for.
    """
    normal = np.asarray(x.T @ x)
    normal[0, 0] *= 1.0 - noise
    return normal


def share_of_inertia(views: Sequence[AxisView]) -> float:
    """Return what a mass can need at most in records that do not tell it, over what the effort gives; rms of both.

    The mass is taken as two standard errors above what is found.
    """
    x, y = _rows(views)
    if len(y) < BLOCKS or not y.any():
        return np.inf
    blocks = _blocks(x, y)
    _, draws = _held_out(blocks, _others(blocks), _chosen([_best(blocks)[1]]))
    error = float(standard_error(draws[:, 0]))
    most = abs(float(draws.mean())) + LEAST_EXCITED * error
    return most * float(np.sqrt(np.mean(x[:, 0] ** 2) / np.mean(y**2)))


class ForceBalance:
    """The force balance of records whose effort is tried in several ways; its columns are those of the motion."""

    def __init__(self, views: Sequence[AxisView]) -> None:
        self._views = views
        self._columns = [_columns(view) for view in views]
        self._motion = np.concatenate([x[ok] for x, ok in self._columns])

    def loss(self, efforts: Sequence[Array]) -> float:
        """Return the smallest held-out loss under these efforts, (n, 1) each, whatever of the columns is left out."""
        tried = zip(self._views, self._columns, efforts, strict=True)
        left = np.concatenate([_residual_effort(view, effort)[ok] for view, (_, ok), effort in tried])
        return _best(_blocks(self._motion, left))[0] if len(left) >= BLOCKS else 0.0


def _best(blocks: Array) -> tuple[float, list[int]]:
    """Return the smallest held-out loss and its columns; those of the position only where they save markedly."""
    others = _others(blocks)
    losses, _ = _held_out(blocks, others, CHOSEN)
    tried = list(zip(losses.tolist(), CHOICES, strict=True))
    plain = min((t for t in tried if BY_PLACE[0] not in t[1] and BEHIND not in t[1]), key=lambda t: t[0])
    for extra in (BEHIND, BY_PLACE[0]):
        other = min(
            (t for t in tried if extra in t[1] and (extra == BY_PLACE[0] or BY_PLACE[0] not in t[1])),
            key=lambda t: t[0],
        )
        if plain[0] > LEFT * float(np.sum(blocks[..., -1] ** 2)) and other[0] < MARKED * plain[0]:
            plain = other
    return plain


def mass_of(views: Sequence[AxisView]) -> float:
    """Return the mass that the records tell, whatever its error, kg or kg m^2; 0 without samples in motion."""
    return _coefficients(views).get(0, 0.0)


def braking_time(views: Sequence[AxisView]) -> float:
    """Return the mass over the viscous friction that the records tell, s; infinite where there is none, or a weight.

    A weight or a spring tells the mass from a lag.
    """
    found = _coefficients(views)
    return np.inf if BY_PLACE[0] in found or not found.get(1, 0.0) > 0.0 else max(found[0], 0.0) / found[1]


def load_mass_of(views: Sequence[AxisView]) -> float:
    """Return the mass that moves with the second encoder, kg or kg m^2; 0 where the records do not tell it."""
    return 0.0 if any(view.run.load is None for view in views) else max(_coefficients(views).get(BEHIND, 0.0), 0.0)


def _coefficients(views: Sequence[AxisView]) -> dict[int, float]:
    """Return column -> its coefficient, of the columns that are worth it; none without samples in motion."""
    x, y = _rows(views)
    if len(y) < BLOCKS:
        return {}
    columns = _best(_blocks(x, y))[1]
    used = x[:, columns]
    return dict(zip(columns, map(float, solve(used.T @ used, used.T @ y)), strict=True))


def _rows(views: Sequence[AxisView]) -> tuple[Array, Array]:
    """Return the equations of all records."""
    rows, target = zip(*(_equations(view) for view in views), strict=True)
    return np.concatenate(rows), np.concatenate(target)


def _blocks(x: Array, y: Array) -> Array:
    """Return the triangles (BLOCKS, p + 1, p + 1) of the equations (n, p) = (n,), in blocks of equal length.

    The triangle of a QR decomposition leaves the same squares as its block, whatever the coefficients.
    """
    rows = np.column_stack([x, y])
    out = np.zeros((BLOCKS, rows.shape[1], rows.shape[1]))
    block = np.arange(len(y)) * BLOCKS // max(len(y), 1)
    for k in range(BLOCKS):
        triangle = np.linalg.qr(rows[block == k], mode="r")
        out[k, : len(triangle)] = triangle
    return out


def _equations(view: AxisView) -> tuple[Array, Array]:
    """Columns (n, 7) and the force (n,) that is left over, where the axis moves."""
    x, ok = _columns(view)
    assert view.run.effort is not None
    return x[ok], _residual_effort(view, view.run.effort)[ok]


def _residual_effort(view: AxisView, effort: Array) -> Array:
    """Return what the motion and the weight leave of an effort (n, 1), on the residual grid, (g,)."""
    return np.asarray(view.run.to_grid(effort)[:, 0] - view.inertial[:, 0])


def _columns(view: AxisView) -> tuple[Array, Mask]:
    """Columns (g, 7) acceleration, velocity, direction, one, two of the position, and the load; where the axis moves.

    Those of the position are a weight at an arm on an axis that turns and a spring on one that slides; none where the
    effort is fed back from the place.
    """
    run = view.run
    q = view.position[:, 0]
    spring = q - q.mean() if view.described.motion == "linear" and not view.fed_back else np.zeros_like(q)
    arm = run.to_grid(np.column_stack([np.sin(run.motor[:, 0]), np.cos(run.motor[:, 0])]))
    by_place = arm.T if view.hangs else (spring, np.zeros_like(q))
    one = np.ones(len(q))
    behind = np.zeros_like(one) if view.load_mass else view.behind[:, 0]
    columns = [view.acceleration[:, 0], view.velocity[:, 0], view.direction, one, *by_place, behind]
    return np.column_stack(columns), view.in_fast_motion


def _chosen(choices: Sequence[Sequence[int]]) -> Mask:
    """Return which columns each choice has, (k, p)."""
    return np.array([np.isin(np.arange(COLUMNS), columns) for columns in choices])


CHOSEN = _chosen(CHOICES)
"""Of every choice its columns."""


def _others(blocks: Array) -> Array:
    """Return the products of columns and target (BLOCKS, p + 1, p + 1), of each block those of all others."""
    return np.tensordot(OTHERS, np.swapaxes(blocks, 1, 2) @ blocks, 1)


def _held_out(blocks: Array, others: Array, chosen: Mask, noise: float = 0.0) -> tuple[Array, Array]:
    """Losses (k,) of all blocks under the others' coefficients, and the mass without each block, (BLOCKS, k).

    Of k choices of columns at once, (k, p): a column that is left out has no data and gets a coefficient of zero.
    """
    normal = others[:, None, :-1, :-1] * (chosen[:, :, None] & chosen[:, None, :])
    normal[..., 0, 0] *= 1.0 - noise
    beta = solve(normal, others[:, None, :-1, -1] * chosen)
    left = blocks[..., -1:] - blocks[..., :-1] @ beta.transpose(0, 2, 1)
    return np.sum(left**2, axis=(0, 1)), beta[..., 0]
