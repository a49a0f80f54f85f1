"""The end of an axis' chain: its position, measured against the axis run again without and with the causes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.localise.floors import UNIFORM
from sher3_diagnosis.quantify.closure import interval_of
from sher3_diagnosis.verdict import Cause, Interval
from sher3_diagnosis.words import quantity
from sher3_machines.thresholds import BLOCKS

from sher3_chain.axes.evidence import AxisEvidence
from sher3_chain.axes.simulate import Law, law_of, simulate, simulated


@dataclass(frozen=True)
class Replay:
    """How well the simulated axis follows the measured one.

    Attributes:
        before, after: rms of the position's error without and with the causes, m or rad.
        closure: of the mean square.
        note: all of it in a sentence.
    """

    before: float
    after: float
    closure: Interval
    note: str


def replay(evidence: AxisEvidence, causes: Sequence[Cause]) -> Replay | None:
    """Run an axis again from its reference, a free one from its release.

    Returns:
        None where it cannot be run again: loop or mass are not known, or no cause is one the simulation takes in.
    """
    axis = evidence.axis
    runs_again = axis.replayable or axis.free
    if not runs_again or evidence.mass <= 0.0 or not {c.effect for c in causes} & simulated().keys():
        return None
    rows, squares = [], []
    count = axis.encoder_resolution / UNIFORM
    for run, view in zip(evidence.runs, evidence.records, strict=True):
        first = view.release if axis.free else 0
        measured = run.signals[axis.name]["position"][first:]
        laws = (Law(), law_of(causes))
        errors = np.column_stack([simulate(run, axis, view.mass, law, first) - measured for law in laws])
        squares.append(np.mean(errors**2, axis=0))
        rows += [[*(np.mean(part**2, axis=0) / count**2), 1.0] for part in np.array_split(errors, BLOCKS)]
    before, after = np.sqrt(np.mean(squares, axis=0))
    kind = "free motion run again from its release" if axis.free else "closed loop run again from its reference"
    nominal, left = (quantity(float(error), axis.unit_of_position) for error in (before, after))
    note = f"{axis.name}: {kind}: position error {nominal} rms nominal, {left} with the causes: "
    note += f"{100.0 * (1.0 - after / before):.1f} % closed in rms"
    return Replay(float(before), float(after), interval_of(np.array(rows)), note)
