"""The effort as it acts: behind a lag or a dead time of the drive, where the force balance says so.

A mass that is identified from an effort ahead of its force is wrong by the lag times the viscous friction. The lag
itself is a cause, and is looked for as every other one. Where only a viscous friction brakes the axis, the lag and the
mass over the friction are two time constants that may change places: the shorter one is then the drive's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sher3_diagnosis.effect import Shape
from sher3_effects import pages
from sher3_effects.page import Page

from sher3_chain.axes.identification.identify import ForceBalance, braking_time
from sher3_chain.axes.view import AxisView
from sher3_chain.joint.description import Axis
from sher3_chain.readings.signals import AxisSignals
from sher3_chain.thresholds import ALIGNED


def acting(signals: Sequence[AxisSignals], axis: Axis) -> Sequence[AxisSignals]:
    """Return the signals with the effort behind the lag that saves most; as they were where it saves too little.

    Args:
        signals: of every record of one axis; all have an effort.
        axis: as described.
    """
    views = [AxisView(s, axis, 0.0) for s in signals]
    lags = [(p, shape) for p in pages("axis") if p.after_effort for shape in p.shapes(views, axis.name)]
    if not lags:
        return signals
    balance = ForceBalance(views)
    plain = balance.loss([s.effort for s in signals if s.effort is not None])
    tried = [[_behind(*lag, s) for s in signals] for lag in lags]
    losses = [balance.loss([s.effort for s in acts if s.effort is not None]) for acts in tried]
    for k in sorted(range(len(lags)), key=losses.__getitem__):
        if not losses[k] < (1.0 - ALIGNED) * plain:
            break
        if max(lags[k][1].values()) < braking_time([AxisView(s, axis, 0.0) for s in tried[k]]):
            return tried[k]
    return signals


def _behind(page: Page, shape: Shape, signals: AxisSignals) -> AxisSignals:
    """Return the signals with the effort as it acts."""
    assert signals.effort is not None
    acts = page.acting(signals.effort[:, 0], signals.stage_clock, signals.period, shape)
    return replace(signals, effort=acts[:, None])
