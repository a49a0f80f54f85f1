"""An effort that was low-passed before it was recorded: which filter it was, and the effort before it.

Drives report a current after a filter of some 10 to 100 Hz, and no description says so. Against motion of 2 Hz a filter
of 17 Hz takes a tenth of the dry friction away and adds half as much to the viscous one. A filter of first or second
order is undone by the derivatives of what came out of it: x = y + y' / w, or y + sqrt(2) y' / w + y'' / w^2
(Butterworth), w = 2 pi times the corner. A pure delay does not look like that: it is no filter where it explains as
much, and is then looked for as a late sensor.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_chain.axes.identification.identify import ForceBalance
from sher3_chain.axes.view import AxisView
from sher3_chain.joint.description import Axis
from sher3_chain.readings.signals import AxisSignals
from sher3_chain.thresholds import ALIGNED

CORNERS = np.geomspace(4.0, 90.0, 10)
"""Corners that are tried, Hz: below the first one nothing of a machine's motion would be left."""
FINER = 4
"""Halvings of the step between two corners."""
OF_NYQUIST = 0.9
"""Share of the Nyquist frequency that a corner stays below: beyond it the record does not show it."""


class Filter(NamedTuple):
    """A low-pass: its corner, Hz, and its order, 1 or 2; order 0 is a delay of as long as a filter of first order."""

    corner: float
    order: int

    def undo(self, signals: AxisSignals) -> AxisSignals:
        """Return the signals with the effort as it was before the filter."""
        if signals.effort is None:
            return signals
        clock, effort, pace = signals.stage_clock, signals.effort, 1.0 / (2.0 * np.pi * self.corner)
        slope, bend = signals.effort_derivatives
        before: Array = (
            np.interp(clock + pace, clock, effort[:, 0])[:, None],
            effort + pace * slope,
            effort + np.sqrt(2.0) * pace * slope + pace**2 * bend,
        )[self.order]
        return replace(signals, effort=before)


def unfiltered(signals: Sequence[AxisSignals], axis: Axis) -> tuple[Sequence[AxisSignals], str]:
    """Return the signals with the effort before its filter, and a note; both as they were where none is told.

    Args:
        signals: of every record of one axis; all have an effort.
        axis: as described.
    """
    top = OF_NYQUIST * 0.5 / signals[0].period
    corners = [float(f) for f in CORNERS if f < top]
    balance = ForceBalance([AxisView(s, axis, 0.0) for s in signals])

    def loss(order: int, corner: float) -> float:
        return balance.loss([s.effort for s in map(Filter(corner, order).undo, signals) if s.effort is not None])

    plain = balance.loss([s.effort for s in signals if s.effort is not None])
    if not plain or not corners:
        return signals, ""
    late, *filters = (_best(partial(loss, order), order, corners, top) for order in (0, 1, 2))
    best = min(filters, key=lambda found: found[0])
    if not best[0] < (1.0 - ALIGNED) * min(plain, late[0]):
        return signals, ""
    found = best[1]
    order = "first" if found.order == 1 else "second"
    note = f"{axis.name}: effort was low-passed before it was recorded, {found.corner:.3g} Hz of {order} order; undone"
    return [found.undo(s) for s in signals], note


def _best(loss: Callable[[float], float], order: int, corners: Sequence[float], top: float) -> tuple[float, Filter]:
    """Return the smallest loss and the filter of an order that has it: on the grid, then by halving its step."""
    tried = {f: loss(f) for f in corners}
    best = min(tried, key=lambda f: tried[f])
    step = float(CORNERS[1] / CORNERS[0])
    for _ in range(FINER):
        step = float(np.sqrt(step))
        for f in (best / step, best * step):
            if f < top:
                tried[f] = loss(f)
        best = min(tried, key=lambda f: tried[f])
    return tried[best], Filter(best, order)
