"""Laws of any shape: what free functions of given inputs leave of a signal, on runs they were not trained on.

An effect is known by the inputs that its law may depend on. If a free function of these inputs takes a remainder away,
the remainder is the shape of the law; if only other inputs do, it is another law.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.fit.trees import Growth, boosted

FOLDS = 3
"""Groups of records, each predicted from the others."""
PIECES = 60
"""Pieces into which all samples are cut where the records are fewer than the groups: enough for a motion that never
comes round to pass in other pieces where it passes in one (arms in MuJoCo, `bench/imperfect.py`: of 8, 24, 60)."""
ROWS = 1500
"""Samples that are looked at, of all runs together."""
KEPT = 12
"""Inputs that a free function is given: those that alone tell most of the signal."""
BINS = 12
"""Bins of an input when it is looked at alone."""
RIDGE = 0.01
"""Ridge of the linear part, share of the variance of an input."""
GROWTH = Growth(trees=25, rate=0.2, leaves=8, bins=32, ridge=5.0)
"""Few small trees: what more of them add is less than a cause is judged by."""
FEW = 60
"""Samples below which nothing is trained."""
ENERGY = 2
"""Directions of a signal of several components that are looked at: those with most energy."""


def loss_left(groups: Sequence[Array], signal: Array, run: NDArray[np.int64]) -> list[float]:
    """Return the mean square per sample that is left of a signal by free functions of ever more inputs.

    Args:
        groups: of inputs, (n, k) each; the second law has those of the first as well, and so on.
        signal: (n, d).
        run: (n,) number of the record of each sample.

    Returns:
        Of each law, the loss over the runs it was not trained on, never more than that of the laws before.
    """
    total = float(np.sum(signal**2)) / len(signal)
    left, fold = signal @ principal(signal), folds(run)
    out: list[float] = []
    given = np.zeros((len(signal), 0))
    for group in groups:
        given = np.hstack([given, group])
        predicted = np.column_stack([crossed(y, fold, partial(_free, given, y)) for y in left.T])
        gain = float(np.sum(left**2) - np.sum((left - predicted) ** 2)) / len(signal)
        if gain > 0.0:
            total, left = total - gain, left - predicted
        out.append(total)
    return out


def principal(signal: Array) -> Array:
    """Return the directions (d, m) of a signal (n, d) with most energy."""
    if signal.shape[1] == 1:
        return np.eye(1)
    return np.linalg.svd(signal.T @ signal)[0][:, :ENERGY]


def folds(record: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the group (n,) of each sample by the number of its record, or of its piece where records are too few."""
    number = np.unique(record, return_inverse=True)[1]
    if number.max(initial=0) < FOLDS - 1:
        number = np.arange(len(record)) * PIECES // len(record)
    return np.asarray(number % FOLDS)


def crossed(y: Array, fold: NDArray[np.int64], free: Callable[[Mask, Mask], Array]) -> Array:
    """Predict y (n,) fold by fold: `free` is given (n,) True at the samples to train on and to predict."""
    out = np.zeros(len(y))
    for k in np.unique(fold):
        if np.sum(fold != k) >= FEW:
            out[fold == k] = free(fold != k, fold == k)
    return out


def _free(inputs: Array, y: Array, train: Mask, test: Mask) -> Array:
    """Fit y (n,) by a free function of the inputs (n, k), a ridge and trees, and predict it; zero without inputs."""
    if not inputs.shape[1]:
        return np.zeros(int(test.sum()))
    chosen = telling(inputs[train], y[train])
    straight = linear(inputs[train], y[train])
    left = y[train] - straight(inputs[train])
    return straight(inputs[test]) + boosted(inputs[train][:, chosen], left, inputs[test][:, chosen], GROWTH)


def linear(inputs: Array, y: Array) -> Callable[[Array], Array]:
    """Return the linear function of the inputs (n, k) that fits y (n,), held down by a ridge: filters are linear."""
    middle, spread = inputs.mean(axis=0), inputs.std(axis=0)
    alive = spread > 1e-9 * max(float(spread.max(initial=0.0)), 1e-300)
    x = (inputs[:, alive] - middle[alive]) / spread[alive]
    ridge = RIDGE * len(y) * np.eye(x.shape[1])
    weights = np.linalg.solve(x.T @ x + ridge, x.T @ (y - y.mean())) if x.shape[1] else np.zeros(0)
    return lambda new: y.mean() + (new[:, alive] - middle[alive]) / spread[alive] @ weights


def telling(inputs: Array, y: Array, kept: int = KEPT) -> NDArray[np.int64]:
    """Return the columns of inputs (n, k) that alone tell most of y (n,)."""
    if inputs.shape[1] <= kept:
        return np.arange(inputs.shape[1])
    edges = np.quantile(inputs, np.linspace(0.0, 1.0, BINS + 1)[1:-1], axis=0)
    gains = [_explained(np.searchsorted(e, x), y) for e, x in zip(edges.T, inputs.T, strict=True)]
    return np.argsort(gains)[::-1][:kept]


def _explained(cell: NDArray[np.int64], y: Array) -> float:
    """Return what the means of y (n,) over cells (n,) take off its sum of squares."""
    count = np.bincount(cell, minlength=BINS)
    return float(np.sum(np.bincount(cell, y, minlength=BINS) ** 2 / np.maximum(count, 1)))
