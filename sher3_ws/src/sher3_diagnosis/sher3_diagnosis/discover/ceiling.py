"""The free-form ceiling: how much of a gap any function of the recorded inputs closes on runs it has not seen.

Boosted trees, cross-fitted by run: what no formula of these inputs can be expected to exceed by much.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_diagnosis.channel import Array
from sher3_diagnosis.discover.columns import Columns
from sher3_diagnosis.discover.feature import Factor, Feature
from sher3_diagnosis.fit.trees import Growth, boosted
from sher3_diagnosis.judge.evidence.free_law import crossed

REACHES = (1e-3, 3e-2, 0.3)
"""Displacements over which the direction is remembered, shares of the range of a position."""
GROWTH = Growth(trees=80, rate=0.12, leaves=31, bins=255, ridge=0.0)
"""Trees: more change the ceiling by less than its interval and cost as much as everything else."""
PAST = (0.01, 0.1)
"""Time constants by which the past is looked at, s."""


def inputs(columns: Columns) -> list[Feature]:
    """Return every quantity, the direction of every position and the past of the own quantities."""
    out = []
    for name, q in columns.quantities[0].items():
        out.append(Feature((Factor("itself", name),)))
        if q.kind == "place":
            span = max(float(np.ptp(run[name].values)) for run in columns.quantities)
            reaches = REACHES if q.own else REACHES[:1]
            out += [Feature((Factor("sliding", name, (s * span,)),)) for s in reaches if span > 0.0]
        if q.own and q.kind in ("force", "speed", "place", "state", "command"):
            out += [Feature((Factor("late", name, (t,)),)) for t in PAST]
    return out


def predicted(columns: Columns, component: int, folds: Sequence[Sequence[int]]) -> list[Array]:
    """Return what the trees predict of a component in every run from the other folds' runs; standardised (N,)."""
    features, runs = inputs(columns), range(len(columns.target))
    x = np.vstack([np.column_stack([columns.at_samples(r, f) for f in features]) for r in runs])
    y, lengths = np.concatenate(columns.target)[:, component], [len(t) for t in columns.target]
    fold = np.repeat([next(k for k, fold in enumerate(folds) if r in fold) for r in runs], lengths)
    guess = crossed(y, fold, lambda train, test: boosted(x[train], y[train], x[test], GROWTH))
    return np.split(guess, np.cumsum(lengths)[:-1])
