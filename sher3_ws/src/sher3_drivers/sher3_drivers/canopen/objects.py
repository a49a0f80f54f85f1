"""The object dictionary of a drive: addresses, types, factory values, and the values the driver needs.

Indices below 0x2000 are communication objects (CiA 301), those from 0x6000 drive objects (CiA 402-2). The host's side,
the mock drives and the tests read the same table.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from sher3_description import ACTUATORS

from sher3_drivers.canopen.cia402 import CYCLIC_SYNCHRONOUS_VELOCITY
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import ENCODER_REVOLUTIONS, SI_UNIT_VELOCITY, AxisScale

NODE_IDS = {name: 1 + place for place, name in enumerate(ACTUATORS)}
"""CANopen node id of every drive: 1 to 5 in the order of ACTUATORS."""

# Identifiers of the pre-defined connection set (CiA 301): a service, and below it the node id of seven bits.
NMT_ID = 0x000
SYNC_ID = 0x080
EMCY_BASE = 0x080
TPDO_BASES = (0x180, 0x280)
RPDO_BASE = 0x200
SDO_RESPONSE_BASE = 0x580
SDO_REQUEST_BASE = 0x600
HEARTBEAT_BASE = 0x700
NODE_MASK = 0x07F
SERVICE_MASK = 0x780

# NMT states as a heartbeat says them (CiA 301, error control protocols).
BOOT_UP = 0
OPERATIONAL = 5

INVALID = 0x80000000
"""Bit 31 of a PDO's COB-ID: the PDO does not exist."""


class Address(int):
    """Index and sub-index of an object in one number, because a number is the cheapest key of a dictionary."""

    def __new__(cls, main: int, sub: int) -> Address:
        """Return the address of index `main`, sub-index `sub`."""
        return super().__new__(cls, main << 8 | sub)

    @property
    def main(self) -> int:
        """Index of the object."""
        return self >> 8

    @property
    def sub(self) -> int:
        """Sub-index of the object."""
        return self & 0xFF

    def __str__(self) -> str:
        return f"0x{self.main:04X}:{self.sub:02X}"

    def __format__(self, spec: str) -> str:
        return format(str(self), spec)


class DriveObject(NamedTuple):
    """One row of the dictionary.

    Attributes:
        name: name of the object in its standard.
        kind: type, unsigned or signed with its number of bits.
        access: `rw`, `ro` or `const`.
    """

    name: str
    kind: Literal["u8", "i8", "u16", "i16", "u32", "i32"]
    access: str


CONTROLWORD = Address(0x6040, 0)
STATUSWORD = Address(0x6041, 0)
MODE = Address(0x6060, 0)
MODE_DISPLAY = Address(0x6061, 0)
MOTOR_POSITION = Address(0x6064, 0)
VELOCITY_DEMAND = Address(0x606B, 0)
TORQUE = Address(0x6077, 0)
LOAD_POSITION = Address(0x60E4, 1)
TARGET_VELOCITY = Address(0x60FF, 0)
ERROR_REGISTER = Address(0x1001, 0)
HOST_HEARTBEAT = Address(0x1016, 1)
DRIVE_HEARTBEAT = Address(0x1017, 0)
ABORT_CONNECTION = Address(0x6007, 0)
QUICK_STOP_DECELERATION = Address(0x6085, 0)
MAX_MOTOR_SPEED = Address(0x6080, 0)
VELOCITY_UNIT = Address(0x60A9, 0)
CYCLE_VALUE = Address(0x60C2, 1)
CYCLE_EXPONENT = Address(0x60C2, 2)

_PDO_INDICES = ((0x1400, 0x1600), (0x1401, 0x1601), (0x1800, 0x1A00), (0x1801, 0x1A01), (0x1802, 0x1A02))

OBJECTS: dict[Address, DriveObject] = {
    Address(0x1000, 0): DriveObject("device type", "u32", "const"),
    ERROR_REGISTER: DriveObject("error register", "u8", "ro"),
    Address(0x1005, 0): DriveObject("COB-ID SYNC", "u32", "rw"),
    Address(0x1014, 0): DriveObject("COB-ID EMCY", "u32", "rw"),
    Address(0x1016, 0): DriveObject("consumer heartbeat entries", "u8", "const"),
    HOST_HEARTBEAT: DriveObject("consumer heartbeat time", "u32", "rw"),
    DRIVE_HEARTBEAT: DriveObject("producer heartbeat time", "u16", "rw"),
    Address(0x1018, 0): DriveObject("identity entries", "u8", "const"),
    Address(0x1018, 1): DriveObject("vendor id", "u32", "const"),
    Address(0x1029, 0): DriveObject("error behaviour entries", "u8", "const"),
    Address(0x1029, 1): DriveObject("NMT state after a communication error", "u8", "rw"),
    ABORT_CONNECTION: DriveObject("abort connection option code", "i16", "rw"),
    CONTROLWORD: DriveObject("controlword", "u16", "rw"),
    STATUSWORD: DriveObject("statusword", "u16", "ro"),
    Address(0x605A, 0): DriveObject("quick stop option code", "i16", "rw"),
    Address(0x605C, 0): DriveObject("disable operation option code", "i16", "rw"),
    Address(0x605E, 0): DriveObject("fault reaction option code", "i16", "rw"),
    MODE: DriveObject("modes of operation", "i8", "rw"),
    MODE_DISPLAY: DriveObject("modes of operation display", "i8", "ro"),
    MOTOR_POSITION: DriveObject("position actual value", "i32", "ro"),
    VELOCITY_DEMAND: DriveObject("velocity demand value", "i32", "ro"),
    Address(0x6076, 0): DriveObject("motor rated torque", "u32", "ro"),
    TORQUE: DriveObject("torque actual value", "i16", "ro"),
    MAX_MOTOR_SPEED: DriveObject("max motor speed", "u32", "rw"),
    QUICK_STOP_DECELERATION: DriveObject("quick stop deceleration", "u32", "rw"),
    Address(0x608F, 0): DriveObject("position encoder resolution entries", "u8", "const"),
    Address(0x608F, 1): DriveObject("encoder increments", "u32", "ro"),
    Address(0x608F, 2): DriveObject("motor revolutions", "u32", "ro"),
    VELOCITY_UNIT: DriveObject("SI unit velocity", "u32", "rw"),
    Address(0x60C2, 0): DriveObject("interpolation time period entries", "u8", "const"),
    CYCLE_VALUE: DriveObject("interpolation time period value", "u8", "rw"),
    CYCLE_EXPONENT: DriveObject("interpolation time index", "i8", "rw"),
    Address(0x60E4, 0): DriveObject("additional position entries", "u8", "const"),
    LOAD_POSITION: DriveObject("additional position actual value", "i32", "ro"),
    Address(0x60E6, 0): DriveObject("additional encoder increments entries", "u8", "const"),
    Address(0x60E6, 1): DriveObject("additional encoder increments", "u32", "ro"),
    Address(0x60EB, 0): DriveObject("additional encoder revolutions entries", "u8", "const"),
    Address(0x60EB, 1): DriveObject("additional encoder revolutions", "u32", "ro"),
    TARGET_VELOCITY: DriveObject("target velocity", "i32", "rw"),
}
for _communication, _mapping in _PDO_INDICES:
    OBJECTS[Address(_communication, 0)] = DriveObject("PDO parameter entries", "u8", "const")
    OBJECTS[Address(_communication, 1)] = DriveObject("PDO COB-ID", "u32", "rw")
    OBJECTS[Address(_communication, 2)] = DriveObject("PDO transmission type", "u8", "rw")
    OBJECTS[Address(_mapping, 0)] = DriveObject("PDO mapped objects", "u8", "rw")
    for _entry in range(1, 5):
        OBJECTS[Address(_mapping, _entry)] = DriveObject(f"PDO mapping entry {_entry}", "u32", "rw")

_EVERY_SYNC, _AT_ONCE = 1, 255
"""Transmission types."""
_SERVO_DRIVE = 0x00020192
"""Device type: profile 402, servo drive."""
_REVOLUTIONS_PER_MINUTE = 0x00B44700
"""Velocity unit that drives ship with."""

BITS = {"u8": 8, "i8": 8, "u16": 16, "i16": 16, "u32": 32, "i32": 32}


class PdoMap(NamedTuple):
    """One process data object (PDO) of a drive.

    Attributes:
        communication: index of its communication parameters.
        mapping: index of its mapping parameters.
        base: its identifier without the node id.
        transmission: 1 to 240 is sent or taken at every n-th SYNC; 255 is taken at once.
        objects: mapped objects, in order.
    """

    communication: int
    mapping: int
    base: int
    transmission: int
    objects: tuple[Address, ...]


RPDO1 = PdoMap(0x1400, 0x1600, RPDO_BASE, _AT_ONCE, (CONTROLWORD, TARGET_VELOCITY))
TPDO1 = PdoMap(0x1800, 0x1A00, TPDO_BASES[0], _EVERY_SYNC, (LOAD_POSITION, STATUSWORD, TORQUE))
TPDO2 = PdoMap(0x1801, 0x1A01, TPDO_BASES[1], _EVERY_SYNC, (MOTOR_POSITION, VELOCITY_DEMAND))
UNUSED = ((0x1401, 0x300), (0x1802, 0x380))
"""PDOs that drives ship with but the bus budget has no room for, (communication object, COB-ID base): switched off."""


def mapping_entry(address: Address) -> int:
    """Return the mapping parameter of an object: index, sub-index and length in bits (CiA 301, object 0x1600)."""
    return address.main << 16 | address.sub << 8 | BITS[OBJECTS[address].kind]


def factory_values(node_id: int, scale: AxisScale) -> dict[Address, int]:
    """Return what a drive holds at power-up: the PDOs of CiA 402-2 by default, no heartbeat, no mode."""
    values = dict.fromkeys(OBJECTS, 0)
    values.update(_identity(scale))
    values.update(
        {Address(0x1005, 0): SYNC_ID, Address(0x1014, 0): EMCY_BASE + node_id, VELOCITY_UNIT: _REVOLUTIONS_PER_MINUTE}
    )
    values.update({MAX_MOTOR_SPEED: 100, QUICK_STOP_DECELERATION: 10000, CYCLE_VALUE: 1, CYCLE_EXPONENT: -3})
    for communication, mapping in _PDO_INDICES:
        values[Address(communication, 0)] = 2
        values[Address(communication, 2)] = _AT_ONCE
        values[Address(mapping, 0)] = 1
        values[Address(mapping, 1)] = mapping_entry(CONTROLWORD if communication < 0x1800 else STATUSWORD)
    bases = (RPDO_BASE, 0x300, TPDO_BASES[0], TPDO_BASES[1], 0x380)
    for (communication, _), base in zip(_PDO_INDICES, bases, strict=True):
        values[Address(communication, 1)] = base + node_id
    return values


def _identity(scale: AxisScale) -> dict[Address, int]:
    """Return what a drive knows of itself; the driver verifies it and does not write it."""
    return {
        Address(0x1000, 0): _SERVO_DRIVE,
        Address(0x6076, 0): scale.rated_milli,
        Address(0x608F, 0): 2,
        Address(0x608F, 1): scale.motor_increments,
        Address(0x608F, 2): ENCODER_REVOLUTIONS,
        Address(0x60E6, 0): 1,
        Address(0x60E6, 1): scale.load_increments,
        Address(0x60EB, 0): 1,
        Address(0x60EB, 1): ENCODER_REVOLUTIONS,
        Address(0x60E4, 0): 1,
        Address(0x1016, 0): 1,
        Address(0x1018, 0): 1,
        Address(0x1029, 0): 1,
        Address(0x60C2, 0): 2,
    }


def required_writes(node_id: int, scale: AxisScale, settings: MotorDriverSettings) -> list[tuple[Address, int]]:
    """Return what the driver writes to a drive, in order; a PDO is invalid while its mapping changes (CiA 301)."""
    writes: list[tuple[Address, int]] = []
    for communication, base in UNUSED:
        writes.append((Address(communication, 1), INVALID | base + node_id))
    for pdo in (RPDO1, TPDO1, TPDO2):
        writes += _pdo_writes(pdo, node_id)
    value, exponent = _cycle(settings.period)
    return [
        *writes,
        (Address(0x1005, 0), SYNC_ID),
        (Address(0x1014, 0), EMCY_BASE + node_id),
        (HOST_HEARTBEAT, settings.host_id << 16 | round(settings.host_heartbeat_limit * 1000)),
        (DRIVE_HEARTBEAT, round(settings.drive_heartbeat * 1000)),
        (Address(0x1029, 1), 1),  # a communication error leaves the NMT state alone, so that the stop stays visible
        (ABORT_CONNECTION, 1),  # a lost host is a fault: the drive brakes and waits for a reset
        (Address(0x605A, 0), 6),  # quick stop brakes on its ramp and stays in QUICK STOP ACTIVE
        (Address(0x605C, 0), 1),  # disable operation brakes first
        (Address(0x605E, 0), 2),  # a fault brakes on the quick stop ramp
        (MODE, CYCLIC_SYNCHRONOUS_VELOCITY),
        (VELOCITY_UNIT, SI_UNIT_VELOCITY),
        (MAX_MOTOR_SPEED, scale.max_motor_speed),
        (QUICK_STOP_DECELERATION, scale.stop_deceleration),
        (CYCLE_VALUE, value),
        (CYCLE_EXPONENT, exponent),
    ]


def required_values(node_id: int, scale: AxisScale, settings: MotorDriverSettings) -> dict[Address, int]:
    """Return what a drive must answer before it may be enabled: everything written, and what it knows of itself."""
    values = _identity(scale)
    values.update(required_writes(node_id, scale, settings))
    values[MODE_DISPLAY] = CYCLIC_SYNCHRONOUS_VELOCITY
    return values


def _pdo_writes(pdo: PdoMap, node_id: int) -> list[tuple[Address, int]]:
    """Return the writes of one PDO: switch it off, map its objects, switch it on."""
    entries = [(Address(pdo.mapping, i), mapping_entry(obj)) for i, obj in enumerate(pdo.objects, 1)]
    return [
        (Address(pdo.communication, 1), INVALID | pdo.base + node_id),
        (Address(pdo.communication, 2), pdo.transmission),
        (Address(pdo.mapping, 0), 0),
        *entries,
        (Address(pdo.mapping, 0), len(pdo.objects)),
        (Address(pdo.communication, 1), pdo.base + node_id),
    ]


_LARGEST_BYTE = 255
_ROUNDING = 1e-6
"""How far a quotient may be off a whole number and still be taken for one; periods are given to nine digits."""


def _cycle(period: float) -> tuple[int, int]:
    """Return (value, exponent) with period = value 10^exponent s, where the value fits one byte (object 0x60C2).

    A period that no such pair gives exactly is rounded to 100 us.
    """
    for exponent in (-3, -4, -5, -6):
        value = period / 10.0**exponent
        if abs(value - round(value)) < _ROUNDING and 1 <= round(value) <= _LARGEST_BYTE:
            return round(value), exponent
    return min(_LARGEST_BYTE, round(period / 1e-4)), -4
