"""Experiments with an axis as its model foresees them: its own motion at another speed, and with a known mass on it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.machine import Rehearsal

from sher3_chain.axes.evidence import AxisEvidence, residuals_of
from sher3_chain.axes.view import AxisView
from sher3_chain.readings.signals import signals_of

SPEEDS = {
    "the same motion at twice the speed": 2.0,
    "the same motion at half the speed": 0.5,
    "the same motion at a quarter of the speed": 0.25,
}
"""What a friction does near rest shows the better the slower the motion; slower still would take too long."""
WEIGHED = "a known mass as large as its own"
WHY = "what the rivals foretell differs most here; within what the axis can do"
WHY_WEIGHED = (
    "a gain of the drive grows with what it must give, a mass stays; described as `carried`, beside this record"
)


def foreseen(evidence: AxisEvidence) -> Iterator[Rehearsal]:
    """Yield the recorded motions faster and slower, and then with a known mass on a driven axis."""
    for name, speed in SPEEDS.items():
        yield Rehearsal(name, WHY, "", _runs(evidence, name, speed, 0.0))
    if evidence.mass > 0.0:
        yield Rehearsal("the same motion", WHY_WEIGHED, WEIGHED, _runs(evidence, "weighed", 1.0, evidence.mass))


def _runs(evidence: AxisEvidence, name: str, speed: float, carried: float) -> Standardised:
    axis = evidence.axis
    runs = [replace(run, period=run.period / speed) for run in evidence.runs]
    views = zip(runs, evidence.records, strict=True)
    records = [AxisView(signals_of(r, axis, name), axis, v.mass + carried, v.load_mass) for r, v in views]
    return evidence.foreseen(records, [residuals_of(view) for view in records])
