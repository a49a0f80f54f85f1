"""An effort that comes early or late on a joint, though its gap is too small to show by its power.

Ten milliseconds change the torque of a slow arm by two per cent, which on a light joint is less than its floor. The
change has a shape of its own, the slope of the force that the joint needs, and over a minute of samples the moment of
the effort is known to a fraction of a millisecond. It is read off beside gain, rotor, spring, friction and a constant
force, so that none of them is taken for it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Mask
from sher3_diagnosis.effect import Shape
from sher3_diagnosis.filter import BANDWIDTH, EDGE, low_pass
from sher3_diagnosis.finding import ExactFinding
from sher3_diagnosis.quantify.closure import interval_of
from sher3_diagnosis.quantify.jackknife import standard_error
from sher3_diagnosis.thresholds import JACKKNIFE
from sher3_diagnosis.verdict import Cause, Interval, Parameter, Residual, Where
from sher3_effects import computed
from sher3_effects.delay import LONGEST_DELAY
from sher3_machines.thresholds import BLOCKS

from sher3_chain.manipulator.evidence import ArmMotionEvidence, channel_of
from sher3_chain.manipulator.identification.gains import friction_columns
from sher3_chain.manipulator.view import MotionView

LATE = "effort_delay"
"""Parameter that these findings give, see `Page.computed`."""
OF_LAW = "delay"
"""The same of a servo whose law stands for the effort: its shape is that of the reference, and is searched."""
WITHIN_PERIOD = 0.5
"""Uncertainty of the moment at which an effort was taken, in periods of the record, where no description states it."""
SLOWER = 5.0
"""Cut-off, Hz, of what is compared: arms move more slowly, and the slope of a noisy acceleration is noise beyond."""
SURE = 2.0
"""Half widths of its 95 % interval by which a delay must exceed that uncertainty."""

IDEAL = 0.015
"""Relative standard error of a delay beside its scatter: noise in the slope makes it too small, by a few per cent."""

WITHIN = (0.0, -1.0, -0.5, 0.5, 1.0)
"""Shares of the half width by which the delay that is taken off may differ from the estimate: the step of a dry
friction is many floors high, and an error within the interval shows in it."""


class Late(NamedTuple):
    """The moment of one joint's effort.

    Attributes:
        delay: s; below zero the effort comes before the motion.
        half: half width of its 95 % interval, s, from a jackknife over blocks.
        slope: rms of the slope of the needed force, N/s or N m/s.
        each: (BLOCKS,) the delay of each block, all else as over the whole record, s.
        unstated: uncertainty of the moment at which an effort was taken, s.
    """

    delay: float
    half: float
    slope: float
    each: Array
    unstated: float

    @property
    def shapes(self) -> list[Shape]:
        """Estimate and standard error of the delay, s, each with another delay within the interval to take off."""
        estimate = {"estimate": self.delay, "error": float(np.hypot(self.half / JACKKNIFE, IDEAL * self.delay))}
        return [{**estimate, "delay": self.delay + share * self.half} for share in WITHIN]

    @property
    def significant(self) -> bool:
        """Whether the record tells that the effort is late or early at all."""
        return abs(self.delay) > SURE * self.half

    @property
    def sure(self) -> bool:
        """Whether the delay exceeds the stated timing uncertainty."""
        return self.unstated + SURE * self.half < abs(self.delay) < LONGEST_DELAY


def with_closure(cause: Cause, shape: Shape) -> Cause:
    """Return the cause of an effort whose delay is told, with the share of its part that taking it off closes.

    Its channel need not show a gap: the delay is then below the floor.
    """
    if "estimate" not in shape:
        return cause
    left = (shape["error"] / shape["estimate"]) ** 2
    closure = Interval(value=1.0 - left, low=1.0 - JACKKNIFE**2 * left, high=1.0)
    return cause.model_copy(update={"closure": closure})


def with_late_readings(cause: Cause) -> Cause:
    """Return a cause with late readings as rival of a late command, where a law stands for the effort."""
    rivals = [*cause.rivals, *([computed(LATE).id] if cause.effect == computed(OF_LAW).id else [])]
    return cause.model_copy(update={"rivals": rivals})


def acting_late(cause: Cause, commanded: Collection[str]) -> Cause:
    """Return an effort that comes before its motion as a command that acts late, where it is what the drive was told.

    Args:
        cause: of a joint.
        commanded: joints whose command stands for the effort, which nobody measured.
    """
    early = cause.parameters.get(LATE)
    if (
        cause.actuator not in commanded
        or early is None
        or early.value >= 0.0
        or early.low is None
        or early.high is None
    ):
        return cause
    page = computed(OF_LAW)
    late = early.model_copy(update={"value": -early.value, "low": -early.high, "high": -early.low})
    rivals = [*cause.rivals, cause.effect]
    return cause.model_copy(update={"effect": page.id, "parameters": {OF_LAW: late}, "rivals": rivals})


def timing_notes(causes: Sequence[Cause]) -> list[str]:
    """Return the sentence on joints whose control and motion lie apart in time."""
    late = ", ".join(cause.actuator for cause in causes if cause.effect == computed(OF_LAW).id)
    said = "without a recorded effort, a command that acts late and a position that is read late are the same records"
    return [f"{late}: control and motion lie apart in time; {said}"] if late else []


def late_efforts(evidence: ArmMotionEvidence) -> list[ExactFinding]:
    """Return the efforts that are late on an arm without any other gap."""
    found = ((joint, lateness(evidence, joint)) for joint in evidence.judged)
    return [_finding(evidence, joint, late) for joint, late in found if late is not None and late.sure]


def lateness(evidence: ArmMotionEvidence, joint: str, carried: Sequence[Mapping[Channel, Array]] = ()) -> Late | None:
    """Return how late a joint's effort is, beside a gain, a rotor, a spring, friction and a constant force.

    None where there are too few samples, or the law of a servo stands for the effort: its reference may be late.

    Args:
        evidence: of the arm.
        joint: whose effort is looked at.
        carried: per block, what a payload adds to the forces that are needed, (g, 1).
    """
    if evidence.records[0].axis(joint).follows:
        return None
    added = {id(view): x.get(channel_of(joint)) for view, x in zip(evidence.views, carried, strict=False)}
    parts = [_equations(view, joint, added.get(id(view))) for view in evidence.records]
    x, y = (np.concatenate([p[i] for p in parts]) for i in (0, 1))
    if len(y) < BLOCKS * x.shape[1]:
        return None
    block = np.arange(len(y)) * BLOCKS // len(y)
    without = np.array([_fitted(x[block != k], y[block != k])[0] for k in range(BLOCKS)])
    found = _fitted(x, y)
    left = y - x[:, 1:] @ found[1:]
    each = np.array([(x[block == k, 0] @ left[block == k]) / np.sum(x[block == k, 0] ** 2) for k in range(BLOCKS)])
    error = float(standard_error(without))
    unstated = WITHIN_PERIOD * max(view.run.period for view in evidence.records)
    return Late(-float(found[0]), JACKKNIFE * error, float(np.sqrt(np.mean(x[:, 0] ** 2))), -each, unstated)


def _equations(view: MotionView, joint: str, carried: Array | None) -> tuple[Array, Array]:
    """Columns (n, 7), the slope of the needed force first, and what the nominal force leaves of the effort, (n,)."""
    row = view.row(joint)
    ok, need = view.in_motion(row), view.inertial[:, row]
    need = need if carried is None else need + carried[:, 0]
    given = view.effort[:, row]
    plain = [np.gradient(need) * view.rate, need, view.acceleration[:, row], view.position[:, row]]
    both = np.column_stack([*plain, friction_columns(view, joint), given - need])
    slow = low_pass(_bridged(both, ok), 1.0 / view.rate, SLOWER)  # noise in a slope would make the delay too small
    spoilt = int(np.ceil(EDGE * BANDWIDTH / SLOWER * view.rate))
    ok = ok & (np.arange(len(ok)) >= spoilt) & (np.arange(len(ok)) < len(ok) - spoilt)
    return slow[ok, :-1], slow[ok, -1]


def _bridged(columns: Array, ok: Mask) -> Array:
    """Return columns (n, k) with straight lines over what cannot be judged: a filter would carry it to its neighbours.

    Lines over gaps are linear in the columns, so that a balance of them that holds beside the gaps holds in them.
    """
    if not ok.any():
        return columns
    every, judged = np.arange(len(ok)), np.flatnonzero(ok)
    return np.column_stack([np.interp(every, judged, x[judged]) for x in columns.T])


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
    page = computed(LATE)
    cause = Cause(
        effect=page.id,
        family=page.family,
        stage=page.stage,
        actuator=joint,
        parameters={LATE: Parameter(value=late.delay, low=low, high=high, unit="s")},
        closure=closure,
    )
    where = Where(
        stage=page.stage,
        actuator=joint,
        gap=gap,
        floor=floor,
        unit=unit,
        regime="everywhere",
        confidence=float(1.0 - np.exp(-gap / floor)),
    )
    return ExactFinding(where, [cause], closure, Residual(gap=float(np.std(left)) * floor, floor=floor, unit=unit))
