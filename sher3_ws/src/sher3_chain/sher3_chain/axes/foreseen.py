"""Experiments with an axis as its model foresees them: its own motion at another speed, and with a known mass on it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from sher3_diagnosis.channel import Floors
from sher3_diagnosis.machine import Rehearsal

from sher3_chain.axes.evidence import AxisEvidence, residuals_of
from sher3_chain.axes.view import AxisView
from sher3_chain.chain.evidence import in_blocks
from sher3_chain.readings.signals import signals_of

SPEEDS = {"the same motion at twice the speed": 2.0, "the same motion at half the speed": 0.5}
WEIGHED = "a known mass as large as its own"
WHY = "what the rivals foretell differs most here; within what the axis can do"


def foreseen(evidence: AxisEvidence) -> Iterator[Rehearsal]:
    """Yield the recorded motions faster and slower, and then with a known mass on a driven axis.

    A mass tells a weight or an inertia, which stay, from a gain of the drive, which grows with what it must give.
    """
    for name, speed in SPEEDS.items():
        yield _rehearsed(evidence, name, speed, "", evidence.mass)
    if evidence.mass > 0.0:
        yield _rehearsed(evidence, "the same motion", 1.0, WEIGHED, 2.0 * evidence.mass)


def _rehearsed(evidence: AxisEvidence, name: str, speed: float, added: str, mass: float) -> Rehearsal:
    axis, floor = evidence.axis, _floors(evidence)
    runs = [replace(run, period=run.period / speed) for run in evidence.runs]
    behind = [view.load_mass for view in evidence.records]
    records = [AxisView(signals_of(r, axis, name), axis, mass, m) for r, m in zip(runs, behind, strict=True)]
    found = [{c: x for c, x in residuals_of(view).items() if c in floor} for view in records]
    return Rehearsal(name, WHY, added, in_blocks(records, found, [floor] * len(records)))


def _floors(evidence: AxisEvidence) -> Floors:
    """Return the floor of every channel, (d,): the median over the records."""
    return {c: np.median([f[c] for f in evidence.floors if c in f], axis=0) for c in evidence.channels}
