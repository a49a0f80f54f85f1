"""One line of text per tick: which samples a control node computed with, so that a run can be computed again."""

from __future__ import annotations

from typing import NamedTuple

from .errors import SettingsError


class AdmittanceRecord(NamedTuple):
    """A tick of the admittance law; stamps in ns, -1 for no sample. `tick` counts from the start of the node."""

    tick: int
    stamp: int
    wrench_stamp: int
    pedal_stamp: int
    joints_stamp: int
    enabled: int
    owner: int
    version: int


class MotionRecord(NamedTuple):
    """A tick of the kinematics node; `mode` is the code of the owner after it, see `MODE_CODES`."""

    tick: int
    stamp: int
    joints_stamp: int
    twist_stamp: int
    enabled: int
    mode: int
    reason: int
    version: int


def record_text(record: AdmittanceRecord | MotionRecord) -> str:
    """Return the numbers separated by blanks."""
    return " ".join(map(str, record))


def admittance_record(text: str) -> AdmittanceRecord:
    """Return the record of a line; raises SettingsError for another one."""
    return AdmittanceRecord(*_numbers(text, len(AdmittanceRecord._fields)))


def motion_record(text: str) -> MotionRecord:
    """Return the record of a line; raises SettingsError for another one."""
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
