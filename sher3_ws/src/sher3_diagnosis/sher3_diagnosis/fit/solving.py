"""Small normal equations, many at once: scaled, with a tiny ridge, and with coefficients that stay within limits.

Compiled, since a search solves a hundred thousand: five coefficients of eight runs with each left out take 8 us, in
NumPy they took 34.
"""

from __future__ import annotations

import math

import numpy as np
from sher3_common.compiled import compiled_ieee

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
    return solve_within(normal, right, np.full(right.shape[-1], np.inf))


def solve_within(normal: Array, right: Array, limit: Array) -> Array:
    """Solve as `solve` does; coefficients whose magnitude would exceed `limit` (p,) are held at it.

    Coefficients are held one round after another, each with its sign: the best fit within the box where the held ones
    do not pull each other back, which is all that small deviations need.
    """
    p, systems = right.shape[-1], math.prod(right.shape[:-1])
    stacked = np.ascontiguousarray(normal, dtype=float).reshape(systems, p, p)
    found: Array = _all_within(stacked, np.ascontiguousarray(right, dtype=float).reshape(systems, p), limit)
    return found.reshape(right.shape)


@compiled_ieee
def leave_one_out(normal: Array, right: Array, limit: Array) -> tuple[Array, Array, Array]:
    """Solve for all runs together and for all but one of them.

    A coefficient with a limit is a deviation of the machine within its tolerance, known up to a prior of one: as much
    its own in the run left out. It is noise that repeats, and no claim that a run must confirm. So beside the causes
    without a run it gets what fits all runs best.

    Args:
        normal: of every run, (runs, p, p).
        right: (runs, p).
        limit: (p,), infinite where nothing is known beforehand.

    Returns:
        Coefficients (p,), those without each run (runs, p), and the normal matrix of all runs (p, p).
    """
    runs, p = right.shape
    own, rest = np.flatnonzero(np.isfinite(limit)), np.flatnonzero(~np.isfinite(limit))
    total, whole = normal.sum(axis=0), right.sum(axis=0)
    prior = total.copy()
    for i in own:
        prior[i, i] += 1.0
    coefficients, held_out = np.empty(p), np.empty((runs, p))
    _within(prior, whole, limit, coefficients)
    if len(rest) == 0:
        held_out[:] = coefficients
        return coefficients, held_out, total
    block, within, found = np.empty((len(own), len(own))), limit[own], np.empty(len(own))
    for a, i in enumerate(own):
        for b, j in enumerate(own):
            block[a, b] = prior[i, j]
    for r in range(runs):
        _within(prior - normal[r], whole - right[r], limit, held_out[r])
        if len(own):
            asked = whole[own]
            for a, i in enumerate(own):
                for j in rest:
                    asked[a] -= held_out[r, j] * prior[j, i]
            _within(block, asked, within, found)
            held_out[r, own] = found
    return coefficients, held_out, total


@compiled_ieee
def loss_under(coefficients: Array, normal: Array, right: Array, energy: Array) -> Array:
    """Return what is left of the energy (runs,) of each run under its coefficients (runs, p); at least zero."""
    out = energy.copy()
    for r in range(len(energy)):
        for i in range(right.shape[1]):
            inner = -2.0 * right[r, i]
            for j in range(right.shape[1]):
                inner += normal[r, i, j] * coefficients[r, j]
            out[r] += coefficients[r, i] * inner
    return np.fmax(out, 0.0)


@compiled_ieee
def _all_within(normal: Array, right: Array, limit: Array) -> Array:
    out = np.empty(right.shape)
    for k in range(len(right)):
        _within(normal[k], right[k], limit, out[k])
    return out


@compiled_ieee
def _within(normal: Array, right: Array, limit: Array, out: Array) -> None:
    """Write the coefficients (p,) within their limits into `out`."""
    p = len(right)
    held = np.zeros(p)
    _scaled(normal, right, out)
    for _ in range(ROUNDS):
        any_beyond = False
        for i in range(p):
            if held[i] == 0.0 and abs(out[i]) > limit[i] * (1.0 + 1e-6):
                held[i], any_beyond = np.sign(out[i]), True
        if not any_beyond:
            return
        stiff, pulled = normal.copy(), right.copy()
        for i in range(p):
            if held[i] != 0.0:
                stiff[i, i] += HOLD * normal[i, i]
                pulled[i] += HOLD * normal[i, i] * held[i] * limit[i]
        _scaled(stiff, pulled, out)


@compiled_ieee
def _scaled(normal: Array, right: Array, out: Array) -> None:
    """Eliminate with pivots of rows, the matrix scaled to unit diagonal: Golub and Van Loan, algorithm 3.4.1."""
    p = len(right)
    scale = np.sqrt(np.diag(normal))
    least = 0.0
    for i in range(p):
        least = max(least, scale[i])
    least = 1e-12 * max(least, 1e-300)
    a, inverse = np.empty((p, p)), np.zeros(p)
    for i in range(p):
        if scale[i] > least:
            inverse[i] = 1.0 / scale[i]
    for i in range(p):
        for j in range(p):
            a[i, j] = normal[i, j] * inverse[i] * inverse[j]
        a[i, i] += RIDGE if inverse[i] > 0.0 else 1.0
        out[i] = right[i] * inverse[i]
    for k in range(p):
        pivot = k
        for i in range(k + 1, p):
            if abs(a[i, k]) > abs(a[pivot, k]):
                pivot = i
        if pivot != k:
            for j in range(k, p):
                a[k, j], a[pivot, j] = a[pivot, j], a[k, j]
            out[k], out[pivot] = out[pivot], out[k]
        for i in range(k + 1, p):
            factor = a[i, k] / a[k, k]
            for j in range(k + 1, p):
                a[i, j] -= factor * a[k, j]
            out[i] -= factor * out[k]
    for k in range(p - 1, -1, -1):
        for j in range(k + 1, p):
            out[k] -= a[k, j] * out[j]
        out[k] /= a[k, k]
    for i in range(p):
        out[i] *= inverse[i]
