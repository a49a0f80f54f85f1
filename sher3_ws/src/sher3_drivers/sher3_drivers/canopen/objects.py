"""The object dictionary of a drive: addresses and types; what they must hold stands in `canopen.configuration`.

Indices below 0x2000 are communication objects (CiA 301), those from 0x6000 drive objects (CiA 402-2). The host's side,
the mock drives and the tests read the same table.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from sher3_description import ACTUATORS

NODE_IDS = {name: 1 + place for place, name in enumerate(ACTUATORS)}
"""CANopen node id of every drive: 1 to 5 in the order of ACTUATORS."""

# Identifiers of the pre-defined connection set (CiA 301): a service, and below it the node id of seven bits.
NMT_ID = 0x000
SYNC_ID = 0x080
EMCY_BASE = 0x080
TPDO_BASES = (0x180, 0x280)
CHECK_BASE = 0x380
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
        optional: the standard lets a drive do without it, and a drive without it has not what it shapes.
    """

    name: str
    kind: Literal["u8", "i8", "u16", "i16", "u32", "i32"]
    access: str
    optional: bool = False

    def pack(self, value: int) -> bytes:
        """Return a value of the object as it goes over the bus, little-endian (CiA 301)."""
        return value.to_bytes(BITS[self.kind] // 8, "little", signed=self.kind.startswith("i"))

    def unpack(self, data: bytes) -> int:
        """Return the value of the object that `data` says."""
        return int.from_bytes(data, "little", signed=self.kind.startswith("i"))


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

POLARITY = Address(0x607E, 0)
LOWER_LIMIT, UPPER_LIMIT = Address(0x607D, 1), Address(0x607D, 2)
MAX_TORQUE = Address(0x6072, 0)
VENDOR, PRODUCT, SERIAL = Address(0x1018, 1), Address(0x1018, 2), Address(0x1018, 4)
RPDO_TIMEOUT = Address(0x1400, 5)
SYNC_COUNTER = Address(0x1019, 0)
COMMAND_CHECK, REPORT_CHECK = Address(0x2F00, 1), Address(0x2F00, 2)

PDO_INDICES = ((0x1400, 0x1600), (0x1401, 0x1601), (0x1800, 0x1A00), (0x1801, 0x1A01), (0x1802, 0x1A02))

OBJECTS: dict[Address, DriveObject] = {
    Address(0x1000, 0): DriveObject("device type", "u32", "const"),
    ERROR_REGISTER: DriveObject("error register", "u8", "ro"),
    Address(0x1005, 0): DriveObject("COB-ID SYNC", "u32", "rw"),
    Address(0x1014, 0): DriveObject("COB-ID EMCY", "u32", "rw"),
    Address(0x1016, 0): DriveObject("consumer heartbeat entries", "u8", "const"),
    HOST_HEARTBEAT: DriveObject("consumer heartbeat time", "u32", "rw"),
    DRIVE_HEARTBEAT: DriveObject("producer heartbeat time", "u16", "rw"),
    Address(0x1018, 0): DriveObject("identity entries", "u8", "const"),
    VENDOR: DriveObject("vendor id", "u32", "const"),
    PRODUCT: DriveObject("product code", "u32", "const", True),
    Address(0x1018, 3): DriveObject("revision", "u32", "const", True),
    SERIAL: DriveObject("serial number", "u32", "const", True),
    SYNC_COUNTER: DriveObject("synchronous counter overflow", "u8", "rw", True),
    Address(0x1029, 0): DriveObject("error behaviour entries", "u8", "const"),
    Address(0x1029, 1): DriveObject("NMT state after a communication error", "u8", "rw"),
    ABORT_CONNECTION: DriveObject("abort connection option code", "i16", "rw"),
    Address(0x2F00, 0): DriveObject("protection entries", "u8", "const", True),
    COMMAND_CHECK: DriveObject("check of the command", "u16", "rw", True),
    REPORT_CHECK: DriveObject("check of the reports", "u16", "ro", True),
    CONTROLWORD: DriveObject("controlword", "u16", "rw"),
    STATUSWORD: DriveObject("statusword", "u16", "ro"),
    Address(0x605A, 0): DriveObject("quick stop option code", "i16", "rw"),
    Address(0x605B, 0): DriveObject("shutdown option code", "i16", "rw", True),
    Address(0x605C, 0): DriveObject("disable operation option code", "i16", "rw"),
    Address(0x605D, 0): DriveObject("halt option code", "i16", "rw", True),
    Address(0x605E, 0): DriveObject("fault reaction option code", "i16", "rw"),
    MODE: DriveObject("modes of operation", "i8", "rw"),
    MODE_DISPLAY: DriveObject("modes of operation display", "i8", "ro"),
    MOTOR_POSITION: DriveObject("position actual value", "i32", "ro"),
    VELOCITY_DEMAND: DriveObject("velocity demand value", "i32", "ro"),
    Address(0x6065, 0): DriveObject("following error window", "u32", "rw", True),
    Address(0x6066, 0): DriveObject("following error time out", "u16", "rw", True),
    MAX_TORQUE: DriveObject("max torque", "u16", "rw", True),
    Address(0x6076, 0): DriveObject("motor rated torque", "u32", "ro"),
    TORQUE: DriveObject("torque actual value", "i16", "ro"),
    Address(0x607C, 0): DriveObject("home offset", "i32", "rw", True),
    Address(0x607D, 0): DriveObject("software position limit entries", "u8", "const", True),
    LOWER_LIMIT: DriveObject("lower software position limit", "i32", "rw", True),
    UPPER_LIMIT: DriveObject("upper software position limit", "i32", "rw", True),
    POLARITY: DriveObject("polarity", "u8", "rw", True),
    Address(0x607F, 0): DriveObject("max profile velocity", "u32", "rw", True),
    MAX_MOTOR_SPEED: DriveObject("max motor speed", "u32", "rw"),
    Address(0x6083, 0): DriveObject("profile acceleration", "u32", "rw", True),
    Address(0x6084, 0): DriveObject("profile deceleration", "u32", "rw", True),
    QUICK_STOP_DECELERATION: DriveObject("quick stop deceleration", "u32", "rw"),
    Address(0x6086, 0): DriveObject("motion profile type", "i16", "rw", True),
    Address(0x608F, 0): DriveObject("position encoder resolution entries", "u8", "const"),
    Address(0x608F, 1): DriveObject("encoder increments", "u32", "ro"),
    Address(0x608F, 2): DriveObject("motor revolutions", "u32", "ro"),
    Address(0x60A8, 0): DriveObject("SI unit position", "u32", "rw", True),
    VELOCITY_UNIT: DriveObject("SI unit velocity", "u32", "rw"),
    Address(0x60AA, 0): DriveObject("SI unit acceleration", "u32", "rw", True),
    Address(0x60B0, 0): DriveObject("position offset", "i32", "rw", True),
    Address(0x60B1, 0): DriveObject("velocity offset", "i32", "rw", True),
    Address(0x60B2, 0): DriveObject("torque offset", "i16", "rw", True),
    Address(0x60C2, 0): DriveObject("interpolation time period entries", "u8", "const"),
    CYCLE_VALUE: DriveObject("interpolation time period value", "u8", "rw"),
    CYCLE_EXPONENT: DriveObject("interpolation time index", "i8", "rw"),
    Address(0x60C5, 0): DriveObject("max acceleration", "u32", "rw", True),
    Address(0x60C6, 0): DriveObject("max deceleration", "u32", "rw", True),
    Address(0x60E0, 0): DriveObject("positive torque limit", "u16", "rw", True),
    Address(0x60E1, 0): DriveObject("negative torque limit", "u16", "rw", True),
    Address(0x60E4, 0): DriveObject("additional position entries", "u8", "const"),
    LOAD_POSITION: DriveObject("additional position actual value", "i32", "ro"),
    Address(0x60E6, 0): DriveObject("additional encoder increments entries", "u8", "const"),
    Address(0x60E6, 1): DriveObject("additional encoder increments", "u32", "ro"),
    Address(0x60EB, 0): DriveObject("additional encoder revolutions entries", "u8", "const"),
    Address(0x60EB, 1): DriveObject("additional encoder revolutions", "u32", "ro"),
    TARGET_VELOCITY: DriveObject("target velocity", "i32", "rw"),
}
OBJECTS[RPDO_TIMEOUT] = DriveObject("RPDO event timer", "u16", "rw", True)
for _communication, _mapping in PDO_INDICES:
    OBJECTS[Address(_communication, 0)] = DriveObject("PDO parameter entries", "u8", "const")
    OBJECTS[Address(_communication, 1)] = DriveObject("PDO COB-ID", "u32", "rw")
    OBJECTS[Address(_communication, 2)] = DriveObject("PDO transmission type", "u8", "rw")
    OBJECTS[Address(_mapping, 0)] = DriveObject("PDO mapped objects", "u8", "rw")
    for _entry in range(1, 5):
        OBJECTS[Address(_mapping, _entry)] = DriveObject(f"PDO mapping entry {_entry}", "u32", "rw")

_EVERY_SYNC, AT_ONCE = 1, 255
"""Transmission types."""
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


RPDO1 = PdoMap(0x1400, 0x1600, RPDO_BASE, AT_ONCE, (CONTROLWORD, TARGET_VELOCITY))
TPDO1 = PdoMap(0x1800, 0x1A00, TPDO_BASES[0], _EVERY_SYNC, (LOAD_POSITION, STATUSWORD, TORQUE))
TPDO2 = PdoMap(0x1801, 0x1A01, TPDO_BASES[1], _EVERY_SYNC, (MOTOR_POSITION, VELOCITY_DEMAND))
CHECKED_RPDO1 = RPDO1._replace(objects=(*RPDO1.objects, COMMAND_CHECK))
TPDO3 = PdoMap(0x1802, 0x1A02, CHECK_BASE, _EVERY_SYNC, (REPORT_CHECK,))
"""With end-to-end protection (`canopen.protection`): the check of a command, and that of both reports."""


def pdos_in_use(protected: bool) -> tuple[PdoMap, ...]:
    """Return the PDOs of a drive, with end-to-end protection or without."""
    return (CHECKED_RPDO1, TPDO1, TPDO2, TPDO3) if protected else (RPDO1, TPDO1, TPDO2)


def pdos_unused(protected: bool) -> tuple[tuple[int, int], ...]:
    """Return PDOs that drives ship with but nobody needs: (communication object, COB-ID base)."""
    return ((0x1401, 0x300),) if protected else ((0x1401, 0x300), (0x1802, CHECK_BASE))


def mapping_entry(address: Address) -> int:
    """Return the mapping parameter of an object: index, sub-index and length in bits (CiA 301, object 0x1600)."""
    return address.main << 16 | address.sub << 8 | BITS[OBJECTS[address].kind]
