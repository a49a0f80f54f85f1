"""Within a period nobody states when a reading was taken: an effort may be that of the middle of its period, or before.

Half a period of 4 ms looks like a viscous friction of mass times jerk, a tenth of the friction of a small arm. What is
found within one period either way is taken off and said; what lies beyond is a late sensor, which is a cause. An effort
that takes energy from a machine without another drive, as a mass below zero would, was recorded with the opposite sign,
unless it pulls towards what the axis was asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_chain.axes.identification.identify import ForceBalance, mass_of
from sher3_chain.axes.identification.unfiltered import unfiltered
from sher3_chain.axes.view import AxisView
from sher3_chain.joint.description import Axis
from sher3_chain.readings.signals import AxisSignals
from sher3_chain.thresholds import ALIGNED

SHIFTS = (-1.0, -0.5, 0.0, 0.5, 1.0)
"""Shifts of the effort that are tried, in periods; the ends only tell whether the best one lies between them."""

PULLS = 0.5
"""Correlation of effort and tracking error from which a drive pulls towards its reference."""


def aligned(signals: Sequence[AxisSignals], axis: Axis) -> tuple[Sequence[AxisSignals], list[str]]:
    """Return the signals with the effort's sign and its moment put right, and a note for each."""
    if any(s.effort is None for s in signals) or axis.free or axis.servo:
        return signals, []
    notes = []
    turned = takes_energy(signals) and not any(map(pulls_home, signals))
    if turned and mass_of([AxisView(s, axis, 0.0) for s in signals]) < 0.0:
        signals = [replace(s, effort=-s.effort) for s in signals if s.effort is not None]
        notes.append(f"{axis.name}: effort recorded with the opposite sign: it would take energy; it was turned")
    signals, note = unfiltered(signals, axis)
    notes += [note] if note else []
    shift = 0.0 if note else best_shift(signals, axis)
    if shift != 0.0:
        signals = [shifted(s, shift) for s in signals]
        when = "before" if shift > 0.0 else "after"
        notes.append(f"{axis.name}: effort was read {abs(shift) * 1e3:.2g} ms {when} its stamp; taken off")
    return signals, notes


def takes_energy(signals: Sequence[AxisSignals]) -> bool:
    """Return whether the effort takes work from the axis in every record, and more than it gives in between.

    A mass or a spring gives back what it took; friction never does, so that over a record an effort gives.
    """
    work = [np.cumsum(s.effort * s.velocity) * s.period for s in signals if s.effort is not None]
    return all(w[-1] < -0.5 * float(np.abs(w).max()) for w in work if len(w))


def pulls_home(signals: AxisSignals) -> bool:
    """Return whether the effort pulls the axis towards its reference: its sign is right, and others drive the axis.

    A foot on the ground, a brake and a generator are driven from outside; what their drives take is no wrong sign.
    """
    if signals.effort is None or signals.reference is None:
        return False
    error = signals.reference[:, 0] - signals.motor[:, 0]
    if not (np.ptp(error) > 0.0 and np.ptp(signals.effort) > 0.0):
        return False
    return bool(np.corrcoef(signals.effort[:, 0], error)[0, 1] > PULLS)


def best_shift(signals: Sequence[AxisSignals], axis: Axis) -> float:
    """Return by how much later the effort is to be read, s, at most half a period; 0 where the record does not tell."""
    period = signals[0].period
    balance = ForceBalance([AxisView(s, axis, 0.0) for s in signals])
    moved = [[shifted(s, n * period).effort for s in signals] for n in SHIFTS]
    losses = np.array([balance.loss([effort for effort in efforts if effort is not None]) for efforts in moved])
    best = int(np.argmin(losses))
    middle = SHIFTS.index(0.0)
    if best in (0, len(SHIFTS) - 1) or not losses[best] < (1.0 - ALIGNED) * losses[middle]:
        return 0.0
    before, at, after = losses[best - 1 : best + 2]
    bend = before - 2.0 * at + after
    finer = 0.5 * (before - after) / bend if bend > 0.0 else 0.0
    return float((SHIFTS[best] + 0.5 * np.clip(finer, -1.0, 1.0)) * period)


def shifted(signals: AxisSignals, shift: float) -> AxisSignals:
    """Return the signals with the effort that was recorded `shift` later, s."""
    if shift == 0.0 or signals.effort is None:
        return signals
    clock = signals.stage_clock
    moved: Array = np.interp(clock + shift, clock, signals.effort[:, 0])[:, None]
    return replace(signals, effort=moved)
