"""Bodies that can exist and move as inertial parameters ask that cannot.

Motion tells base parameters: sums over links (Gautier and Khalil 1990). Given to single links they may need a negative
mass. A body can exist where its pseudo-inertia, a matrix (4, 4), is positive definite (Wensing, Kim and Slotine 2018),
which the product of a triangular matrix with itself always is: among such bodies those are taken that need the wanted
forces, and of them those next to the model's.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from sher3_diagnosis.channel import Array

from sher3_chain.manipulator.rigid.dynamics import regressor
from sher3_chain.manipulator.rigid.tree import MATRIX, PARAMETERS, SIX, Tree

POSTURES = 200
"""Random states in which forces are compared: each gives an equation for every joint."""
SPEED, ACCELERATION = 2.0, 10.0
"""Of those states, rad/s and rad/s^2 or m/s and m/s^2: spin and acceleration then ask for as much as weight does."""
TURN, TRAVEL = np.pi, 0.5
"""Positions of those states, rad and m, of joints that state no reach."""
NEAR = 1e-3
"""Share of a joint's usual force that a step of one mean body away from the model is held for."""
SIZE = 0.1
"""Length, m, that makes moments and inertias of kilograms: of the order of a link's centre."""
THIN, DUST = 0.01, 1e-4
"""Least radius of gyration, m, and least mass as a share of the mean body's."""
DONE = 1e-6
"""Share of the sum of squares below which a step ends the search: it took 3000 steps for 2e-4 of the sum, 84 now."""
LOWER = np.tril_indices(4)


def physical(tree: Tree, own: Array, change: Array, places: NDArray[np.int64]) -> Array:
    """Return the inertial parameters of bodies that can exist and move all joints as changed ones would.

    Args:
        tree: of the joints.
        own: parameters of the bodies that may change, (n, 10), each in the frame of its joint.
        change: that is wanted of every link, (links, 10).
        places: joint in the tree of each of those bodies, (n,).
    """
    columns = (PARAMETERS * places[:, None] + np.arange(PARAMETERS)).ravel()
    force, needed = _forces(tree, change.ravel())
    base = np.linalg.qr(np.column_stack([force[:, columns], needed]), mode="r")
    body = max(float(np.mean(own[:, 0])), np.finfo(float).tiny)
    unit = np.tile(body * SIZE ** np.repeat([0.0, 1.0, 2.0], [1, 3, 6]), len(own))
    least = DUST * body * np.diag([THIN**2] * 3 + [1.0])
    of = np.arange(len(own))

    def bodies(lower: Array) -> Array:
        x = _matrices(lower)
        return _parameters(x @ x.swapaxes(1, 2) + least).ravel()

    def left(lower: Array) -> Array:
        step = bodies(lower) - own.ravel()
        return np.concatenate([base[:, :-1] @ step - base[:, -1], NEAR * step / unit])

    def slope(lower: Array) -> Array:
        step = np.zeros((*own.shape, *own.shape))
        step[of, :, of] = _slopes(_matrices(lower))
        step = step.reshape(own.size, own.size)
        return np.concatenate([base[:, :-1] @ step, NEAR * step / unit[:, None]])

    start = np.concatenate([_lower(_pseudo(x) - least) for x in own])
    return bodies(least_squares(left, start, slope, ftol=DONE, x_scale="jac").x).reshape(own.shape)


def can_exist(inertial: Array) -> bool:
    """Return whether there is a body with these inertial parameters (10,)."""
    return float(np.linalg.eigvalsh(_pseudo(inertial))[0]) >= 0.0


def _forces(tree: Tree, change: Array) -> tuple[Array, Array]:
    """Return the force per parameter, (N, 10 links), and that of a change, (N,), in shares of what a joint needs."""
    rng = np.random.default_rng(0)
    slides = np.array([link.slides for link in tree.links])
    reach = np.minimum([link.reach for link in tree.links], np.where(slides, TRAVEL, TURN))
    q = rng.uniform(-reach, reach, (POSTURES, len(reach)))
    x = regressor(tree, q, *(size * rng.standard_normal(q.shape) for size in (SPEED, ACCELERATION)))
    usual = np.sqrt(np.mean((x @ tree.inertial) ** 2, axis=0))
    x = x / (np.maximum(usual, 1e-6 * usual.max()) * np.sqrt(x[..., 0].size))[:, None]
    rows = x.reshape(-1, x.shape[-1])
    return rows, rows @ change


def _matrices(lower: Array) -> Array:
    """Return triangular matrices, (n, 4, 4), of their numbers, (10 n,)."""
    out = np.zeros((len(lower) // PARAMETERS, 4, 4))
    out[:, LOWER[0], LOWER[1]] = lower.reshape(-1, PARAMETERS)
    return out


def _slopes(lower: Array) -> Array:
    """Return the slopes of bodies' parameters over the numbers of their triangular matrices (n, 4, 4), (n, 10, 10)."""
    half = UNITS @ lower[:, None].swapaxes(2, 3)
    return _parameters(half + half.swapaxes(2, 3)).swapaxes(1, 2)


def _lower(pseudo: Array) -> Array:
    """Return the triangular matrix, (10,) of it, of the pseudo-inertia next to one that may be none."""
    values, vectors = np.linalg.eigh(pseudo)
    floor = max(1e-9 * values[-1], np.finfo(float).tiny)
    found: Array = np.linalg.cholesky((vectors * np.maximum(values, floor)) @ vectors.T)[LOWER]
    return found


def _pseudo(inertial: Array) -> Array:
    """Return the pseudo-inertia (4, 4) of inertial parameters (10,)."""
    about = inertial[4:][np.array(MATRIX)]
    moment = inertial[1:4, None]
    return np.block([[0.5 * np.trace(about) * np.eye(3) - about, moment], [moment.T, inertial[:1, None]]])


def _parameters(pseudo: Array) -> Array:
    """Return the inertial parameters (..., 10) of pseudo-inertias (..., 4, 4)."""
    second = pseudo[..., :3, :3]
    about = np.trace(second, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - second
    return np.concatenate([pseudo[..., 3, 3:], pseudo[..., :3, 3], about[..., SIX[0], SIX[1]]], axis=-1)


UNITS = _matrices(np.eye(PARAMETERS).ravel())
"""The ten triangular matrices of a single one, (10, 4, 4)."""
