"""Small normal equations, many at once: scaled, with a tiny ridge, and with coefficients that stay within limits."""

from __future__ import annotations

import numpy as np

from sher3_diagnosis.channel import Array

RIDGE = 1e-9
"""Relative ridge on the normal equations: keeps collinear columns solvable without moving well-posed fits."""
HOLD = 1e6
"""Weight, relative to the data's own, that holds a coefficient at its limit."""
ROUNDS = 6
"""Rounds in which coefficients beyond their limit are held at it."""


def solve(normal: Array, right: Array) -> Array:
    """Solve normal equations (..., p, p) and (..., p) scaled to unit diagonal, with a tiny ridge.

    Columns without data get zero.
    """
    p = right.shape[-1]
    if p == 0:
        return np.zeros(right.shape)
    scale = np.sqrt(np.diagonal(normal, axis1=-2, axis2=-1))
    alive = scale > 1e-12 * np.maximum(scale.max(axis=-1, keepdims=True), 1e-300)
    inverse = 1.0 / np.where(alive, scale, np.inf)
    a = normal * inverse[..., :, None] * inverse[..., None, :]
    np.einsum("...ii->...i", a)[...] += np.where(alive, RIDGE, 1.0)  # a view of the diagonals
    found: Array = np.linalg.solve(a, (right * inverse)[..., None])[..., 0] * inverse
    return found


def solve_within(normal: Array, right: Array, limit: Array) -> Array:
    """Solve as `solve` does; coefficients whose magnitude would exceed `limit` (p,) are held at it.

    Coefficients are held one round after another, each with its sign: the best fit within the box where the held ones
    do not pull each other back, which is all that small deviations need.
    """
    found = solve(normal, right)
    if not np.isfinite(limit).any():
        return found
    held = np.zeros(found.shape)
    for _ in range(ROUNDS):
        beyond = (np.abs(found) > limit * (1.0 + 1e-6)) & (held == 0.0)
        if not beyond.any():
            break
        held = np.where(beyond, np.sign(found), held)
        weight = np.where(held == 0.0, 0.0, HOLD * np.diagonal(normal, axis1=-2, axis2=-1))
        stiff = normal.copy()
        stiff[..., range(len(limit)), range(len(limit))] += weight
        found = solve(stiff, right + weight * held * np.where(np.isfinite(limit), limit, 0.0))
    return found
