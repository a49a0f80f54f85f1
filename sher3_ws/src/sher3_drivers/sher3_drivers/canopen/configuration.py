"""What a drive holds when it gets its power, what the driver writes to it, and what it must answer before it may move.

A drive is closed when every object that shapes its motion was written and read back: units, signs, offsets, ramps,
limits, and what it does when something is lost. What the standard leaves optional may be missing (`DriveObject`): a
drive without polarity has none that could be wrong.
"""

from __future__ import annotations

from sher3_description import ACTUATORS

from sher3_drivers.canopen import objects as od
from sher3_drivers.canopen.cia402 import CYCLIC_SYNCHRONOUS_VELOCITY
from sher3_drivers.canopen.objects import INVALID, OBJECTS, Address, PdoMap, mapping_entry
from sher3_drivers.canopen.protection import COUNTS
from sher3_drivers.settings import DriveIdentity, MotorDriverSettings
from sher3_drivers.units import ENCODER_REVOLUTIONS, SI_UNIT_VELOCITY, AxisScale

_SERVO_DRIVE = 0x00020192
"""Device type: profile 402, servo drive."""
_REVOLUTIONS_PER_MINUTE = 0x00B44700
"""Velocity unit that drives ship with."""
_INCREMENTS, _RPM_PER_SECOND = 0x00B50000, 0x00C00300
"""Position unit and acceleration unit (objects 0x60A8, 0x60AA): those that drives ship with."""
_HARDEST = 10
"""Accelerations that a drive allows, in limits of its axis: the host keeps the limit, the drive refuses nonsense."""
MOCK_IDENTITY = DriveIdentity(drive=ACTUATORS[0], vendor=0x5348, product=0x3003, serial=1)
"""Identity of the first mock drive; the others have its vendor and product, and their node id as serial number."""


def factory_values(node_id: int, scale: AxisScale) -> dict[Address, int]:
    """Return what a drive holds at power-up: the PDOs of CiA 402-2 by default, no heartbeat, no mode."""
    values = dict.fromkeys(OBJECTS, 0)
    values.update(_identity(scale))
    values.update(_name_plate(MOCK_IDENTITY.model_copy(update={"serial": node_id})))
    values.update({Address(0x1005, 0): od.SYNC_ID, Address(0x1014, 0): od.EMCY_BASE + node_id})
    values.update({od.VELOCITY_UNIT: _REVOLUTIONS_PER_MINUTE, Address(0x60A8, 0): _INCREMENTS})
    values.update({Address(0x60AA, 0): _RPM_PER_SECOND, Address(0x2F00, 0): 2, Address(0x607D, 0): 2})
    values.update({od.MAX_MOTOR_SPEED: 100, od.QUICK_STOP_DECELERATION: 10000})
    values.update({od.CYCLE_VALUE: 1, od.CYCLE_EXPONENT: -3})
    for communication, mapping in od.PDO_INDICES:
        values[Address(communication, 0)] = 5
        values[Address(communication, 2)] = od.AT_ONCE
        values[Address(mapping, 0)] = 1
        values[Address(mapping, 1)] = mapping_entry(od.CONTROLWORD if communication < 0x1800 else od.STATUSWORD)
    bases = (od.RPDO_BASE, 0x300, *od.TPDO_BASES, od.CHECK_BASE)
    for (communication, _), base in zip(od.PDO_INDICES, bases, strict=True):
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


def _name_plate(identity: DriveIdentity) -> dict[Address, int]:
    return {od.VENDOR: identity.vendor, od.PRODUCT: identity.product, od.SERIAL: identity.serial}


def required_writes(node_id: int, scale: AxisScale, settings: MotorDriverSettings) -> list[tuple[Address, int]]:
    """Return what the driver writes to a drive, in order; a PDO is invalid while its mapping changes (CiA 301)."""
    writes: list[tuple[Address, int]] = []
    for communication, base in od.pdos_unused(settings.protected):
        writes.append((Address(communication, 1), INVALID | base + node_id))
    for pdo in od.pdos_in_use(settings.protected):
        writes += _pdo_writes(pdo, node_id)
    return [*writes, *_communication(node_id, settings), *_reactions(), *_motion(scale, settings)]


def _communication(node_id: int, settings: MotorDriverSettings) -> list[tuple[Address, int]]:
    """Return identifiers, the counter of SYNC, and how long either side may be silent."""
    return [
        (Address(0x1005, 0), od.SYNC_ID),
        (od.SYNC_COUNTER, COUNTS if settings.protected else 0),
        (Address(0x1014, 0), od.EMCY_BASE + node_id),
        (od.HOST_HEARTBEAT, settings.host_id << 16 | round(settings.host_heartbeat_limit * 1000)),
        (od.DRIVE_HEARTBEAT, round(settings.drive_heartbeat * 1000)),
        (od.RPDO_TIMEOUT, round(settings.host_heartbeat_limit * 1000)),
    ]


def _reactions() -> list[tuple[Address, int]]:
    """Return what a drive does when something is lost or taken away: it brakes on a ramp that was written too."""
    return [
        (Address(0x1029, 1), 1),  # a communication error leaves the NMT state alone, so that the stop stays visible
        (od.ABORT_CONNECTION, 1),  # a lost host is a fault: the drive brakes and waits for a reset
        (Address(0x605A, 0), 6),  # quick stop brakes on its ramp and stays in QUICK STOP ACTIVE
        (Address(0x605B, 0), 1),  # shutdown brakes first
        (Address(0x605C, 0), 1),  # disable operation brakes first
        (Address(0x605D, 0), 1),  # halt brakes on the ramp; nobody asks for it
        (Address(0x605E, 0), 2),  # a fault brakes on the quick stop ramp
    ]


def _motion(scale: AxisScale, settings: MotorDriverSettings) -> list[tuple[Address, int]]:
    """Return units, signs, offsets, ramps and limits."""
    value, exponent = _cycle(settings.period)
    lower, upper = scale.position_limits
    window = settings.encoder_total_angle if scale.revolute else settings.encoder_total_distance
    return [
        (od.MODE, CYCLIC_SYNCHRONOUS_VELOCITY),
        (Address(0x60A8, 0), _INCREMENTS),
        (od.VELOCITY_UNIT, SI_UNIT_VELOCITY),
        (Address(0x60AA, 0), _RPM_PER_SECOND),
        (od.POLARITY, 0),
        (Address(0x607C, 0), 0),  # home offset
        (Address(0x60B0, 0), 0),  # offsets that a drive adds to its targets: position,
        (Address(0x60B1, 0), 0),  # velocity,
        (Address(0x60B2, 0), 0),  # torque
        (od.LOWER_LIMIT, lower),
        (od.UPPER_LIMIT, upper),
        (Address(0x6065, 0), scale.motor_counts(window)),
        (Address(0x6066, 0), round(settings.encoder_latency * 1000)),
        (od.MAX_TORQUE, scale.max_torque),
        (Address(0x60E0, 0), scale.max_torque),
        (Address(0x60E1, 0), scale.max_torque),
        (od.MAX_MOTOR_SPEED, scale.max_motor_speed),
        (Address(0x607F, 0), scale.max_motor_speed * 1_000_000),
        (Address(0x6086, 0), 0),  # linear ramps
        (Address(0x6083, 0), scale.stop_deceleration),
        (Address(0x6084, 0), scale.stop_deceleration),
        (od.QUICK_STOP_DECELERATION, scale.stop_deceleration),
        (Address(0x60C5, 0), _HARDEST * scale.stop_deceleration),
        (Address(0x60C6, 0), _HARDEST * scale.stop_deceleration),
        (od.CYCLE_VALUE, value),
        (od.CYCLE_EXPONENT, exponent),
    ]


def required_values(node_id: int, scale: AxisScale, settings: MotorDriverSettings) -> dict[Address, int]:
    """Return what a drive must answer before it may be enabled: everything written, and what it knows of itself."""
    values = _identity(scale)
    for identity in settings.identities:
        if od.NODE_IDS[identity.drive] == node_id:
            values.update(_name_plate(identity))
    values.update(required_writes(node_id, scale, settings))
    values[od.MODE_DISPLAY] = CYCLIC_SYNCHRONOUS_VELOCITY
    return values


def holds(address: Address, found: int, required: int) -> bool:
    """Return whether an object holds what it must; a number of entries (sub-index 0) may be larger than needed."""
    return found >= required if OBJECTS[address].name.endswith("entries") else found == required


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
