"""An effort that comes early or late on a joint whose gap is too small to show by its power.

Ten milliseconds change the torque of a slow arm by two per cent, which on a light joint is less than its floor. The
change has a shape of its own, the slope of the force that the joint needs, and over a minute of samples the moment of
the effort is known to a fraction of a millisecond. It is read off where nothing else is wrong with the arm.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.filter import low_pass
from sher3_diagnosis.finding import ExactFinding
from sher3_diagnosis.localise.gaps import localise
from sher3_diagnosis.quantify.closure import interval_of
from sher3_diagnosis.quantify.jackknife import standard_error
from sher3_diagnosis.thresholds import JACKKNIFE
from sher3_diagnosis.verdict import Cause, Parameter, Residual, Where
from sher3_effects.timing.sensor_delay import SensorDelay

from sher3_machines.manipulator.evidence import ArmMotionEvidence, channel_of
from sher3_machines.manipulator.gains import friction_columns
from sher3_machines.manipulator.view import MotionView
from sher3_machines.thresholds import BLOCKS

WITHIN_PERIOD = 0.5
"""Periods of the record within which nobody states when an effort was taken."""
SLOWER = 5.0
"""Cut-off, Hz, of what is compared: arms move more slowly, and the slope of a noisy acceleration is noise beyond."""
SURE = 2.0
"""Half widths of the 95 % interval that a delay must lie beyond that."""


class Late(NamedTuple):
    """The moment of one joint's effort.

    Attributes:
        delay: s; below zero the effort comes before the motion.
        half: half width of its 95 % interval, s, from a jackknife over blocks.
        slope: rms of the slope of the needed force, N/s or N m/s.
        each: (BLOCKS,) the delay of each block, all else as over the whole record, s.
    """

    delay: float
    half: float
    slope: float
    each: Array


def late_efforts(evidence: ArmMotionEvidence) -> list[ExactFinding]:
    """Return the efforts that are late on an arm without any other gap; none on an arm with one."""
    if any(gap.significant for gap in localise(evidence)):
        return []
    period = max(view.run.period for view in evidence.records)
    out = []
    for joint in evidence.judged:
        late = lateness(evidence, joint)
        if late is not None and abs(late.delay) > WITHIN_PERIOD * period + SURE * late.half:
            out.append(_finding(evidence, joint, late))
    return out


def lateness(evidence: ArmMotionEvidence, joint: str) -> Late | None:
    """Return how late a joint's effort is, beside a gain, a rotor, a spring, friction and a constant force.

    None where there are too few samples.
    """
    parts = [_equations(view, joint) for view in evidence.records]
    x, y = (np.concatenate([p[i] for p in parts]) for i in (0, 1))
    if len(y) < BLOCKS * x.shape[1]:
        return None
    block = np.arange(len(y)) * BLOCKS // len(y)
    without = np.array([_fitted(x[block != k], y[block != k])[0] for k in range(BLOCKS)])
    found = _fitted(x, y)
    left = y - x[:, 1:] @ found[1:]
    each = np.array([(x[block == k, 0] @ left[block == k]) / np.sum(x[block == k, 0] ** 2) for k in range(BLOCKS)])
    error = float(standard_error(without))
    return Late(-float(found[0]), JACKKNIFE * error, float(np.sqrt(np.mean(x[:, 0] ** 2))), -each)


def _equations(view: MotionView, joint: str) -> tuple[Array, Array]:
    """Columns (n, 7), the slope of the needed force first, and what the nominal force leaves of the effort, (n,)."""
    row = view.row(joint)
    ok, need = view.in_motion(row), view.inertial[:, row]
    assert view.run.effort is not None
    given = view.run.to_grid(view.run.effort)[:, row]
    plain = [np.gradient(need) * view.rate, need, view.acceleration[:, row], view.position[:, row]]
    both = np.column_stack([*plain, friction_columns(view, joint), given - need])
    slow = low_pass(both, 1.0 / view.rate, SLOWER)[ok]  # noise in a slope would make the delay too small
    return slow[:, :-1], slow[:, -1]


def _fitted(x: Array, y: Array) -> Array:
    """Coefficients (7,) by least squares; effort(t) = needed(t - delay) is less by delay times the slope, the first."""
    length = np.maximum(np.linalg.norm(x, axis=0), np.finfo(float).tiny)
    return np.asarray(np.linalg.lstsq(x / length, y, rcond=None)[0] / length)


def _finding(evidence: ArmMotionEvidence, joint: str, late: Late) -> ExactFinding:
    gap, floor = abs(late.delay) * late.slope, late.half / JACKKNIFE * late.slope
    block = floor * np.sqrt(BLOCKS) / late.slope  # a block alone tells the delay by so much worse
    left = (late.each - late.delay) / block
    losses = np.column_stack([(late.each / block) ** 2, left**2, np.ones(BLOCKS)])
    closure, unit = interval_of(losses), evidence.unit(channel_of(joint), 0)
    low, high = late.delay - late.half, late.delay + late.half
    cause = Cause(
        effect=SensorDelay.id,
        family=SensorDelay.family,
        stage=SensorDelay.stage,
        actuator=joint,
        parameters={"effort_delay": Parameter(value=late.delay, low=low, high=high, unit="s")},
        closure=closure,
    )
    where = Where(
        stage=SensorDelay.stage,
        actuator=joint,
        gap=gap,
        floor=floor,
        unit=unit,
        regime="everywhere",
        confidence=float(1.0 - np.exp(-gap / floor)),
    )
    return ExactFinding(where, [cause], closure, Residual(gap=float(np.std(left)) * floor, floor=floor, unit=unit))
