"""The object dictionary of a drive as data: addresses, types, what it ships with and what the driver needs it to hold.

CiA 301 (communication objects) and CiA 402 (drive objects). Plain data: the drives' side, the host's side and the
tests read the same table.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from .cia402 import CYCLIC_SYNCHRONOUS_VELOCITY
from .settings import MotorDriverSettings
from .units import ENCODER_REVOLUTIONS, SI_UNIT_VELOCITY, AxisScale

SYNC_ID = 0x080
EMCY_BASE = 0x080
TPDO_BASES = (0x180, 0x280)
RPDO_BASE = 0x200
SDO_REQUEST_BASE = 0x600
HEARTBEAT_BASE = 0x700
NMT_ID = 0x000
INVALID = 0x80000000
"""Bit 31 of a PDO's COB-ID: the PDO does not exist."""


class Address(int):
    """Index and sub-index of an object in one number, as cheap a dictionary key as there is."""

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
    """One row of the dictionary: its name, type (`u8` to `i32`) and access (`rw`, `ro`, `const`)."""

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
    Address(0x60A9, 0): DriveObject("SI unit velocity", "u32", "rw"),
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

BITS = {"u8": 8, "i8": 8, "u16": 16, "i16": 16, "u32": 32, "i32": 32}


class PdoMap(NamedTuple):
    """One PDO: its two objects, COB-ID base, transmission type and mapped objects in order."""

    communication: int
    mapping: int
    base: int
    transmission: int
    objects: tuple[Address, ...]


RPDO1 = PdoMap(0x1400, 0x1600, RPDO_BASE, 255, (CONTROLWORD, TARGET_VELOCITY))
TPDO1 = PdoMap(0x1800, 0x1A00, TPDO_BASES[0], 1, (LOAD_POSITION, STATUSWORD, TORQUE))
TPDO2 = PdoMap(0x1801, 0x1A01, TPDO_BASES[1], 1, (MOTOR_POSITION, VELOCITY_DEMAND))
UNUSED = ((0x1401, 0x300), (0x1802, 0x380))
"""Further PDOs that drives ship with, (communication object, COB-ID base): not in the bus budget, so switched off."""


def mapping_entry(address: Address) -> int:
    """Return the mapping parameter of an object: index, sub-index and length in bits."""
    return address.main << 16 | address.sub << 8 | BITS[OBJECTS[address].kind]


def factory_values(node_id: int, scale: AxisScale) -> dict[Address, int]:
    """Return what a drive holds at power-up: CiA 402 default PDOs, no heartbeat, no mode."""
    values = dict.fromkeys(OBJECTS, 0)
    values.update(_identity(scale))
    values.update(
        {Address(0x1005, 0): SYNC_ID, Address(0x1014, 0): EMCY_BASE + node_id, Address(0x60A9, 0): 0x00B44700}
    )
    values.update({MAX_MOTOR_SPEED: 100, QUICK_STOP_DECELERATION: 10000, CYCLE_VALUE: 1, CYCLE_EXPONENT: -3})
    for communication, mapping in _PDO_INDICES:
        values[Address(communication, 0)] = 2
        values[Address(communication, 2)] = 255
        values[Address(mapping, 0)] = 1
        values[Address(mapping, 1)] = mapping_entry(CONTROLWORD if communication < 0x1800 else STATUSWORD)
    bases = (RPDO_BASE, 0x300, TPDO_BASES[0], TPDO_BASES[1], 0x380)
    for (communication, _), base in zip(_PDO_INDICES, bases, strict=True):
        values[Address(communication, 1)] = base + node_id
    return values


def _identity(scale: AxisScale) -> dict[Address, int]:
    """Return what a drive knows of itself and the driver only verifies."""
    return {
        Address(0x1000, 0): 0x00020192,
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
    """Return what the driver writes to a drive, in order (CiA 301: a PDO is invalid while its mapping changes)."""
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
        (Address(0x60A9, 0), SI_UNIT_VELOCITY),
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
    entries = [(Address(pdo.mapping, i), mapping_entry(obj)) for i, obj in enumerate(pdo.objects, 1)]
    return [
        (Address(pdo.communication, 1), INVALID | pdo.base + node_id),
        (Address(pdo.communication, 2), pdo.transmission),
        (Address(pdo.mapping, 0), 0),
        *entries,
        (Address(pdo.mapping, 0), len(pdo.objects)),
        (Address(pdo.communication, 1), pdo.base + node_id),
    ]


def _cycle(period: float) -> tuple[int, int]:
    """Return (value, exponent) with period = value 10^exponent s and value <= 255."""
    for exponent in (-3, -4, -5, -6):
        value = period / 10.0**exponent
        if abs(value - round(value)) < 1e-6 and 1 <= round(value) <= 255:
            return round(value), exponent
    return min(255, round(period / 1e-4)), -4
