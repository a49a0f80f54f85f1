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

FINER = 3
"""Rounds of a finer search for the lag."""


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

    def loss(acts: Sequence[AxisSignals]) -> float:
        return balance.loss([s.effort for s in acts if s.effort is not None])

    def tried(some: Sequence[tuple[Page, Shape]]) -> list[tuple[float, tuple[Page, Shape], list[AxisSignals]]]:
        behind = [(lag, _behind(*lag, signals)) for lag in some]
        return [(loss(acts), lag, acts) for lag, acts in behind if _brakes_later(acts, axis, lag)]

    best = min(tried(lags), key=lambda found: found[0], default=None)
    if best is None or not best[0] < (1.0 - ALIGNED) * loss(signals):
        return signals
    for _ in range(FINER):
        page, shape = best[1]
        near = tried([(page, finer) for finer in page.refine(shape)])
        best = min((best, *near), key=lambda found: found[0])
    return best[2]


def _brakes_later(acts: Sequence[AxisSignals], axis: Axis, lag: tuple[Page, Shape]) -> bool:
    """Return whether a lag is shorter than the time in which friction brakes the mass that is then found."""
    return max(lag[1].values()) < braking_time([AxisView(s, axis, 0.0) for s in acts])


def _behind(page: Page, shape: Shape, signals: Sequence[AxisSignals]) -> list[AxisSignals]:
    """Return the signals with the effort as it acts."""
    acts = [page.acting(s.effort[:, 0], s.stage_clock, s.period, shape) for s in signals if s.effort is not None]
    return [replace(s, effort=x[:, None]) for s, x in zip(signals, acts, strict=True)]
