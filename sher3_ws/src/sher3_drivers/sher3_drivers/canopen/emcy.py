"""Emergency messages (EMCY): what a drive says went wrong (CiA 301, emergency error codes; CiA 402-2, error codes)."""

from __future__ import annotations

import struct
from typing import NamedTuple

from sher3_common.reasons import Reason

from sher3_drivers.errors import FrameError

EMCY = struct.Struct("<HB5s")
"""Error code, error register (object 0x1001), five bytes of the manufacturer (CiA 301, emergency object)."""

SAFE_TORQUE_OFF = 0x5441
"""Code of a drive whose safe torque off has taken the torque from its motor."""
COMMAND_LOST, COMMAND_GARBLED = 0x8250, 0xFF02
"""Codes of a drive that has had no command for the event time of its RPDO, and of one whose commands fail their check.
"""
HOST_LOST = 0x8130
"""Code of a drive that misses the host's heartbeat (CiA 301, life guard or heartbeat error)."""

CODES: dict[int, str] = {
    0x0000: "error reset or no error",
    0x1000: "generic error",
    0x2310: "continuous over-current",
    0x2320: "short circuit or earth leakage",
    0x2340: "short circuit in the motor windings",
    0x3210: "DC link over-voltage",
    0x3220: "DC link under-voltage",
    0x4210: "over-temperature of the device",
    0x4310: "over-temperature of the drive",
    0x5113: "low 5 V supply",
    SAFE_TORQUE_OFF: "enable input missing (safe torque off)",
    0x6100: "internal software error",
    0x6320: "parameter error",
    0x7121: "motor blocked",
    0x7305: "motor encoder error",
    0x7306: "load encoder error",
    0x7320: "position sensor error",
    0x8110: "CAN overrun: frames lost",
    0x8120: "CAN error passive",
    HOST_LOST: "heartbeat of the host lost",
    0x8140: "recovered from bus-off",
    0x8210: "PDO not processed: too short",
    0x8220: "PDO longer than mapped",
    0x8240: "unexpected SYNC length",
    COMMAND_LOST: "RPDO timeout",
    0x8400: "velocity following error",
    0x8611: "position following error",
    0x8612: "reference limit",
    COMMAND_GARBLED: "manufacturer: commands fail their check",
    0xFF01: "manufacturer: set-point out of range",
}

# By the high byte of a code.
_FAMILIES: dict[int, str] = {
    0x10: "generic error",
    0x20: "current",
    0x21: "current, input side",
    0x22: "current inside the device",
    0x23: "current, output side",
    0x30: "voltage",
    0x31: "mains voltage",
    0x32: "voltage inside the device",
    0x33: "output voltage",
    0x40: "temperature",
    0x41: "ambient temperature",
    0x42: "device temperature",
    0x50: "device hardware",
    0x60: "device software",
    0x70: "additional modules",
    0x80: "monitoring",
    0x81: "communication",
    0x82: "protocol",
    0x86: "positioning controller",
    0x90: "external error",
    0xF0: "additional functions",
    0xFF: "manufacturer-specific",
}


class Emergency(NamedTuple):
    """A decoded EMCY.

    Attributes:
        code: emergency error code.
        register: error register, object 0x1001.
        data: five bytes of the manufacturer.
        text: what the code means.
    """

    code: int
    register: int
    data: bytes
    text: str

    @property
    def is_reset(self) -> bool:
        """Whether the drive says its error is gone."""
        return self.code >> 8 == 0

    def __str__(self) -> str:
        return f"EMCY 0x{self.code:04X} ({self.text}), error register 0x{self.register:02X}"


def decode_emergency(data: bytes) -> Emergency:
    """Return the decoded EMCY; a code that is not in the table is described by its family.

    Raises:
        FrameError: it has not 8 bytes.
    """
    if len(data) != EMCY.size:
        raise FrameError("an EMCY has 8 bytes", value=len(data), limit=EMCY.size, remedy="check the COB-ID assignment")
    code, register, extra = EMCY.unpack(data)
    family = _FAMILIES.get(code >> 8, _FAMILIES.get(code >> 8 & 0xF0, "unknown family"))
    return Emergency(code, register, extra, CODES.get(code, f"{family}, code not in the table"))


_TEMPERATURE = 0x4
"""High digit of every code about temperature."""


_REASONS = {
    SAFE_TORQUE_OFF: Reason.SAFE_TORQUE_OFF,
    HOST_LOST: Reason.DRIVE_HOST_LOST,
    COMMAND_LOST: Reason.DRIVE_HOST_LOST,
}


def reason_of(code: int) -> Reason:
    """Return the reason an emergency code stands for: temperature (0x4xxx), one of `_REASONS`, or any other."""
    if code >> 12 == _TEMPERATURE:
        return Reason.DRIVE_OVER_TEMPERATURE
    return _REASONS.get(code, Reason.DRIVE_EMERGENCY)
