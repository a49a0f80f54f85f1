"""Error frames: what a CAN controller says about its bus (include/uapi/linux/can/error.h).

python-can reports a socketcan bus as active whatever happens. Bus off and error passive show in these frames alone.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

from sher3_drivers.bus.frame import ERROR_FLAG, Frame

# Error classes: bits of the identifier of an error frame.
_CLASS_CONTROLLER = 0x004
_CLASS_NO_ACKNOWLEDGE = 0x020
_CLASS_BUS_OFF = 0x040
_CLASS_RESTARTED = 0x100
_CLASSES = 0x1FF
# Status of the controller: bits of data byte 1. Both directions, receiving and sending, have a bit each.
_OVERFLOW = 0x03
_WARNING = 0x0C
_PASSIVE = 0x30
_ACTIVE = 0x40
_SENDING_WARNING, _SENDING_PASSIVE = 0x08, 0x20


class BusCondition(IntEnum):
    """State of a CAN controller, worst last (ISO 11898-1, fault confinement)."""

    ACTIVE = 0
    WARNING = 1
    PASSIVE = 2
    OFF = 3


class ErrorReport(NamedTuple):
    """A decoded error frame.

    Attributes:
        condition: the condition the controller is in now, None when the frame does not say.
        text: a sentence.
    """

    condition: BusCondition | None
    text: str


def decode_error(frame: Frame) -> ErrorReport | None:
    """Return what an error frame reports; None for an ordinary frame."""
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
    return ErrorReport(None, f"error class 0x{frame.can_id & _CLASSES:03x}")


_DETAILS = {
    BusCondition.ACTIVE: _ACTIVE,
    BusCondition.WARNING: _SENDING_WARNING,
    BusCondition.PASSIVE: _SENDING_PASSIVE,
}


def error_frame(condition: BusCondition) -> Frame:
    """Return the error frame a controller emits on entering `condition`; for tests and fault injection."""
    if condition is BusCondition.OFF:
        return Frame(ERROR_FLAG | _CLASS_BUS_OFF, bytes(8))
    return Frame(ERROR_FLAG | _CLASS_CONTROLLER, bytes((0, _DETAILS[condition], 0, 0, 0, 0, 0, 0)))
