"""What a predictor with inputs leaves of a residual: the innovation of a driven signal.

A second difference foresees a signal that bends slowly. Of one that is driven faster, by steps of a reference or about
a resonance, it leaves most, and a floor made of that hides the gap itself. Known inputs foresee such a signal: a
residual is predicted from its own past, the motion's and the reference, by a model that was fitted to the other half of
the record (ARX: Ljung 1999, section 4.2).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sher3_diagnosis.channel import Array, Residual
from sher3_diagnosis.localise.floors import GAUSSIAN

from sher3_chain.readings.signals import AxisSignals

Rows = NDArray[np.signedinteger]
PAST = 4
"""Samples of the residual grid that the predictor sees: four are enough for two resonances, or a lag and a delay."""
ENOUGH = 5
"""Samples for each number of the predictor at least."""


def foreseen(run: AxisSignals, residual: Residual, way: Array) -> float:
    """Return the standard deviation of white noise that would leave as much as the predictor does; inf if too short.

    Args:
        run: whose motion and reference are the inputs.
        residual: of one component, on its grid.
        way: sense of the motion as dry friction has it, (g,). A sweep turns within a sample or two: neither a line nor
            the past foresees the step of its friction then. Tried beside the predictor without it: a force that is read
            late does not follow it.
    """
    y, ok = residual.values[:, 0], residual.ok
    past = [np.roll(y, k) for k in range(1, PAST + 1)]
    inputs = [np.roll(run.smooth[run.grid, 0], k) for k in range(1, PAST + 1)]
    if run.reference is not None:
        asked = run.to_grid(run.reference)[:, 0]
        inputs += [np.roll(asked, k) for k in range(PAST + 1)]
    rows = np.flatnonzero(np.all([np.roll(ok, k) for k in range(PAST + 1)], axis=0))
    rows = rows[rows >= PAST]
    plain = np.column_stack([*past, *inputs, np.ones_like(y)])
    if len(rows) < 2 * ENOUGH * plain.shape[1]:
        return np.inf
    noise = run.filtered(np.random.default_rng(0).normal(size=(run.ticks, 1)))[:: run.stride, 0]
    one, other = np.array_split(rows, 2)
    tried = (plain, np.column_stack([plain, way]))
    halves = ((one, other), (other, one))
    return min(0.5 * sum(_prediction_innovation(x, y, *rows, noise) for rows in halves) for x in tried)


def _prediction_innovation(x: Array, y: Array, fitted: Rows, judged: Rows, noise: Array) -> float:
    """Return the standard deviation of white noise with the innovation that a predictor leaves on `judged` rows.

    Args:
        x: inputs, (g, p), its own past first.
        y: residual, (g,).
        fitted: rows that the predictor is fitted to.
        judged: the others.
        noise: white noise after the filter of the residuals, (n,), of a known standard deviation.
    """
    size = np.linalg.norm(x[fitted], axis=0)
    size[size == 0.0] = 1.0
    beta = np.linalg.lstsq(x[fitted] / size, y[fitted], rcond=1e-9)[0] / size
    gain = np.convolve(noise, np.concatenate([[1.0], -beta[:PAST]]), "valid").std() / noise.std()
    return float(GAUSSIAN * np.median(np.abs(y[judged] - x[judged] @ beta)) / gain)
