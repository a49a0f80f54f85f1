"""Error frames: what the CAN controller says about the bus. include/uapi/linux/can/error.h.

python-can reports a socketcan bus as active whatever happens; bus-off and error-passive are only in these frames.
"""

from __future__ import annotations

import struct
from enum import IntEnum
from typing import NamedTuple

from sher3_description.reasons import Reason

from .frame import ERROR_FLAG, Frame
from .trips import Trip

_CLASS_CONTROLLER = 0x004
_CLASS_NO_ACKNOWLEDGE = 0x020
_CLASS_BUS_OFF = 0x040
_CLASS_RESTARTED = 0x100
_OVERFLOW = 0x03
_WARNING = 0x0C
_PASSIVE = 0x30
_ACTIVE = 0x40


class BusCondition(IntEnum):
    """Health of a CAN controller, worst last."""

    ACTIVE = 0
    WARNING = 1
    PASSIVE = 2
    OFF = 3


class ErrorReport(NamedTuple):
    """A decoded error frame: the `condition` it sets (None: it says nothing about it) and a sentence."""

    condition: BusCondition | None
    text: str


def decode_error(frame: Frame) -> ErrorReport | None:
    """Return what an error frame reports, None for an ordinary frame."""
    if not frame.can_id & ERROR_FLAG:
        return None
    detail = frame.data[1] if len(frame.data) > 1 else 0
    if frame.can_id & _CLASS_BUS_OFF:
        return ErrorReport(BusCondition.OFF, "bus off: the controller took itself off the bus after 256 errors")
    if frame.can_id & _CLASS_RESTARTED:
        return ErrorReport(BusCondition.ACTIVE, "controller restarted")
    if frame.can_id & _CLASS_CONTROLLER:
        if detail & _PASSIVE:
            return ErrorReport(BusCondition.PASSIVE, "error passive: more than 127 errors")
        if detail & _WARNING:
            return ErrorReport(BusCondition.WARNING, "error warning: more than 96 errors")
        if detail & _ACTIVE:
            return ErrorReport(BusCondition.ACTIVE, "error active again")
        if detail & _OVERFLOW:
            return ErrorReport(None, "controller buffer overflow: frames lost")
    if frame.can_id & _CLASS_NO_ACKNOWLEDGE:
        return ErrorReport(None, "no acknowledgement: no other node on the bus")
    return ErrorReport(None, f"error class 0x{frame.can_id & 0x1FF:03x}")


def judge_error(conditions: list[BusCondition], channel: int, link: str, frame: Frame) -> Trip | None:
    """Note what an error frame says of a channel in `conditions`; object to error passive and bus-off."""
    report = decode_error(frame)
    if report is None or report.condition is None:
        return None
    conditions[channel] = report.condition
    if report.condition < BusCondition.PASSIVE:
        return None
    reason = Reason.BUS_OFF if report.condition is BusCondition.OFF else Reason.BUS_PASSIVE
    return Trip(reason, f"{link}: {report.text}")


def error_frame(condition: BusCondition) -> Frame:
    """Return the error frame a controller emits on entering `condition`; for tests and fault injection."""
    if condition is BusCondition.OFF:
        return Frame(ERROR_FLAG | _CLASS_BUS_OFF, bytes(8))
    detail = {BusCondition.ACTIVE: _ACTIVE, BusCondition.WARNING: 0x08, BusCondition.PASSIVE: 0x20}[condition]
    return Frame(ERROR_FLAG | _CLASS_CONTROLLER, struct.pack("<8B", 0, detail, 0, 0, 0, 0, 0, 0))
