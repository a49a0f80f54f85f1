"""One line of text per tick: the samples that a control node computed with, so that a run can be computed again."""

from __future__ import annotations

from typing import NamedTuple

from sher3_control.errors import SettingsError


class AdmittanceRecord(NamedTuple):
    """A tick of the admittance node.

    Attributes:
        tick: counts from the start of the node.
        stamp: the tick [ns].
        wrench_stamp, pedal_stamp, joints_stamp: of the samples it used [ns], -1 for none.
        enabled: 1 when the robot was ENABLED for this node.
        owner: 1 when the cooperative mode owned the robot, or nobody did.
        version: of the live parameters.
    """

    tick: int
    stamp: int
    wrench_stamp: int
    pedal_stamp: int
    joints_stamp: int
    enabled: int
    owner: int
    version: int


class MotionRecord(NamedTuple):
    """A tick of the kinematics node.

    Attributes:
        tick: counts from the start of the node.
        stamp: the tick [ns].
        joints_stamp, twist_stamp: of the samples it used [ns], -1 for none.
        enabled: 1 when the robot was ENABLED for this node.
        mode: code of the owner after the tick, see `MODE_CODES`.
        reason: why there was no motion, a number of `Reason`.
        version: of the node's settings.
    """

    tick: int
    stamp: int
    joints_stamp: int
    twist_stamp: int
    enabled: int
    mode: int
    reason: int
    version: int


def record_text(record: AdmittanceRecord | MotionRecord) -> str:
    """Return the numbers of a record, separated by blanks."""
    return " ".join(map(str, record))


def admittance_record(text: str) -> AdmittanceRecord:
    """Return the record of a line; raises SettingsError for a damaged line."""
    return AdmittanceRecord(*_numbers(text, len(AdmittanceRecord._fields)))


def motion_record(text: str) -> MotionRecord:
    """Return the record of a line; raises SettingsError for a damaged line."""
    return MotionRecord(*_numbers(text, len(MotionRecord._fields)))


def _numbers(text: str, count: int) -> list[int]:
    words = text.split()
    try:
        numbers = [int(word) for word in words]
    except ValueError:
        numbers = []
    if len(numbers) != count:
        raise SettingsError("a tick record is damaged", value=text[:80], limit=count, remedy="record the run again")
    return numbers
