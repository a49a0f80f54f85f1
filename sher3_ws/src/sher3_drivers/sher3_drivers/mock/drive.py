"""One mock drive: a CANopen node with the CiA 402 state machine, its own stop ramps and the PDOs its dictionary maps.

It believes only its object dictionary: a wrong PDO map, COB-ID or unit that the host sets has the same effect here as
on hardware. The state machine is written from the bits of the controlword and not from the host's table; a test
compares the two.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from operator import itemgetter
from typing import Any, NamedTuple

from sher3_drivers.bus.frame import FRAME_SIZE, HEADER_FORMAT, pack_frame
from sher3_drivers.canopen import objects as od
from sher3_drivers.canopen.cia402 import CYCLIC_SYNCHRONOUS_VELOCITY
from sher3_drivers.canopen.configuration import factory_values
from sher3_drivers.canopen.device import CanopenDevice
from sher3_drivers.canopen.emcy import COMMAND_GARBLED, COMMAND_LOST, EMCY, HOST_LOST, SAFE_TORQUE_OFF
from sher3_drivers.canopen.objects import Address
from sher3_drivers.canopen.protection import OLDEST_COMMAND, check_of, count_before
from sher3_drivers.units import SI_UNIT_VELOCITY, AxisScale

NOT_READY, SWITCH_ON_DISABLED, READY, SWITCHED_ON, ENABLED = 0x00, 0x40, 0x21, 0x23, 0x27
QUICK_STOP, FAULT_REACTION, FAULT = 0x07, 0x0F, 0x08
_CHECK = struct.Struct("<H6x")
_REMOTE, _VOLTAGE, _LIMIT_ACTIVE, _FOLLOWS = 0x0200, 0x0010, 0x0800, 0x1000
_PDO_TOO_SHORT = 0x8210
_GARBLED_LIMIT = 3
"""Commands in a row that fail their check, after which a drive stops by itself."""
_GO_ON = 0x0F
"""Controlword that keeps an enabled drive enabled."""
_HALF = 1 << 31
_FORMATS = {"u8": "B", "i8": "b", "u16": "H", "i16": "h", "u32": "I", "i32": "i"}


class AxisReading(NamedTuple):
    """What the plant says of one axis at a SYNC, in m or rad, m/s or rad/s, N or N m."""

    motor_position: float
    load_position: float
    velocity_demand: float
    effort: float


def next_state(state: int, word: int, previous: int) -> int:
    """Return the state after a controlword, from its bits 0 to 3 and 7 (CiA 402-2)."""
    if state == FAULT:
        return SWITCH_ON_DISABLED if word & 0x80 and not previous & 0x80 else FAULT
    if state in (NOT_READY, FAULT_REACTION) or word & 0x80:
        return state
    if not word & 0x02:  # enable voltage
        return SWITCH_ON_DISABLED
    if not word & 0x04:  # quick stop, active low
        return QUICK_STOP if state in (ENABLED, QUICK_STOP) else SWITCH_ON_DISABLED
    if not word & 0x01:  # switch on
        return state if state == QUICK_STOP else READY
    if not word & 0x08:  # enable operation
        return SWITCHED_ON if state in (READY, ENABLED) else state
    return {READY: SWITCHED_ON, SWITCHED_ON: ENABLED, QUICK_STOP: ENABLED}.get(state, state)


class _Pdo:
    """A PDO compiled from the dictionary: struct of the whole frame and the mapped addresses."""

    def __init__(self, values: dict[Address, int], communication: int, mapping: int) -> None:
        self.can_id = values[Address(communication, 1)]
        self.transmission = values[Address(communication, 2)]
        entries = [values[Address(mapping, i)] for i in range(1, 1 + min(4, values[Address(mapping, 0)]))]
        self.addresses = [Address(entry >> 16, entry >> 8 & 0xFF) for entry in entries]
        layout = "".join(_FORMATS[od.OBJECTS[address].kind] for address in self.addresses if address in od.OBJECTS)
        self.length = struct.calcsize("<" + layout)
        self.exists = not self.can_id & od.INVALID and len(layout) == len(entries) > 0 and self.length <= 8
        self.layout = layout
        self.checked = self.addresses[-1:] == [od.COMMAND_CHECK]
        self.controlword = self.addresses.index(od.CONTROLWORD) if od.CONTROLWORD in self.addresses else None
        self.data = struct.Struct("<" + layout)


def _wrapped(count: int) -> int:
    """Return a count as its register of 32 bits holds it."""
    return count if -_HALF <= count < _HALF else (count + _HALF) % (2 * _HALF) - _HALF


def _picker(keys: Sequence[Any]) -> Callable[[Any], tuple[Any, ...]]:
    """Return what takes the values of `keys`, at least one, out of a dictionary or a tuple."""
    return itemgetter(*keys) if len(keys) > 1 else lambda values: (values[keys[0]],)


_READINGS = (od.LOAD_POSITION, od.STATUSWORD, od.TORQUE, od.MOTOR_POSITION, od.VELOCITY_DEMAND)
"""Objects that are new at every SYNC."""


class _Tpdos:
    """The synchronous TPDOs of a drive as frames end to end, packed in one call.

    Attributes:
        data: where their data are in the frames.
    """

    def __init__(self, pdos: Sequence[_Pdo], channel: int) -> None:
        headers = [struct.pack(f"<{HEADER_FORMAT}", pdo.can_id, pdo.length, channel) for pdo in pdos]
        self._pack = struct.Struct("<" + "".join(f"8s{pdo.layout}{8 - pdo.length}x" for pdo in pdos)).pack
        addresses = [address for pdo in pdos for address in pdo.addresses]
        self._others = tuple(address for address in addresses if address not in _READINGS)
        keys: list[int] = []
        for number, pdo in enumerate(pdos):
            keys.append(len(_READINGS) + number)
            for address in pdo.addresses:
                if address in _READINGS:
                    keys.append(_READINGS.index(address))
                else:
                    keys.append(len(_READINGS) + len(headers) + self._others.index(address))
        self._headers = tuple(headers)
        self.data = [slice(FRAME_SIZE * number + 8, FRAME_SIZE * (number + 1)) for number in range(len(headers))]
        self._pick = _picker(keys) if keys else lambda _: ()

    def frames(self, readings: tuple[int, ...], values: dict[Address, int]) -> bytes:
        """Return the frames for the `_READINGS` of this SYNC and, for other mapped objects, the dictionary."""
        others = tuple([values[address] for address in self._others]) if self._others else ()
        return self._pack(*self._pick((*readings, *self._headers, *others)))


class MockDrive:
    """A drive on the bus.

    Args:
        scale: scales of its axis.
        node_id: its CANopen node id.
        send: takes whole frames for the bus.
        channel: number of its channel, which its TPDOs are marked with (`frame.bundle`).

    Attributes:
        state: CiA 402 state, one of this module's constants.
        due: time at which `watch` is to be called next, ns.
        powered: False makes it silent and deaf.
        counter: counter of the newest SYNC.
        torque_off: its safe torque off input is open, so that its motor has no torque.
        tamper: replaces the reading before it is reported. The seam for stuck, wrong, delayed and garbage values.
        mistake: replaces the target velocity [counts] of a command that has arrived whole.
        stray: replaces the velocity that the power stage executes, as long as it has power; the echo does not show it.
        turned: replaces the velocity of the motor, with power or without.
        misstates: bits of the statusword that are the other way.
    """

    def __init__(self, scale: AxisScale, node_id: int, send: Callable[[bytes], None], channel: int = 0) -> None:
        self.scale, self.node_id = scale, node_id
        self.due = 0
        self._channel = channel
        self.state = SWITCH_ON_DISABLED
        self.powered = True
        self.tamper: Callable[[AxisReading], AxisReading] | None = None
        self.mistake: Callable[[float], float] | None = None
        self.stray: Callable[[float], float] | None = None
        self.turned: Callable[[float], float] | None = None
        self.misstates = 0
        self.counter = 0
        self.torque_off = False
        self._garbled, self._commanded = 0, 0
        self._astray = 0.0
        self._send_frames = send
        self._demand = 0
        self._previous_word = 0
        self._heard_host: int | None = None
        self._limited = False
        self._readings: tuple[int, ...] = ()
        factory = factory_values(node_id, scale)
        self.node = CanopenDevice(node_id, self._send, factory, self._on_write, self._on_reset)
        self._compile()
        self._read_settings()

    def _send(self, frames: bytes) -> None:
        if self.powered:
            self._send_frames(frames)

    def _compile(self) -> None:
        values = self.node.values
        rpdos = [_Pdo(values, c, m) for c, m in ((0x1400, 0x1600), (0x1401, 0x1601))]
        tpdos = [_Pdo(values, c, m) for c, m in ((0x1800, 0x1A00), (0x1801, 0x1A01), (0x1802, 0x1A02))]
        self._rpdos = {pdo.can_id: pdo for pdo in rpdos if pdo.exists}
        sent = [pdo for pdo in tpdos if pdo.exists and 1 <= pdo.transmission <= 240]
        checks = [pdo for pdo in sent if pdo.addresses == [od.REPORT_CHECK]]
        self._tpdos = _Tpdos([pdo for pdo in sent if pdo not in checks], self._channel)
        headers = [struct.pack(f"<{HEADER_FORMAT}", pdo.can_id, pdo.length, self._channel) for pdo in checks]
        self._check_header = headers[0] if headers else None

    def _read_settings(self) -> None:
        """Take over what the dictionary says of velocities; called after every access to it."""
        values = self.node.values
        self._follows = values[od.MODE_DISPLAY] == CYCLIC_SYNCHRONOUS_VELOCITY
        self._micro = 1 if values[od.VELOCITY_UNIT] == SI_UNIT_VELOCITY else 1_000_000
        self._limit = values[od.MAX_MOTOR_SPEED] * 1_000_000 // self._micro

    def _on_reset(self) -> None:
        self.state = SWITCH_ON_DISABLED
        self._demand, self._previous_word, self._heard_host = 0, 0, None
        self._garbled = self._commanded = 0

    def _on_write(self, address: Address, value: int) -> None:
        if address == od.CONTROLWORD:
            self._on_controlword(value)
        elif address == od.MODE and value in (0, CYCLIC_SYNCHRONOUS_VELOCITY):
            self.node.values[od.MODE_DISPLAY] = value

    # Frames in.

    def receive(self, can_id: int, data: bytes, now: int) -> None:
        """Take one frame of the bus that is no SYNC; `data` has the frame's length."""
        if not self.powered:
            return
        if self.node.operational and can_id in self._rpdos:
            self._on_rpdo(self._rpdos[can_id], data, now)
            return
        self.due = 0
        if can_id == od.NMT_ID or can_id == 0x600 + self.node_id:
            self.node.values.update(zip(_READINGS, self._readings, strict=False))
            self.node.handle(can_id, data)
            self._read_settings()
            if can_id == od.NMT_ID:
                self._compile()
        elif can_id == od.HEARTBEAT_BASE + (self.node.values[od.HOST_HEARTBEAT] >> 16 & 0x7F):
            self._heard_host = now

    def _on_rpdo(self, pdo: _Pdo, data: bytes, now: int) -> None:
        if len(data) < pdo.length:
            self.emergency(_PDO_TOO_SHORT)
            return
        if pdo.checked and not self._is_whole(data[: pdo.length]):
            self._garbled += 1
            if self._garbled == _GARBLED_LIMIT:
                self.fault(COMMAND_GARBLED)
            return
        self._garbled, self._commanded = 0, now
        received = pdo.data.unpack_from(data)
        self.node.values.update(zip(pdo.addresses, received, strict=True))
        if self.mistake is not None:
            self.node.values[od.TARGET_VELOCITY] = round(self.mistake(self.node.values[od.TARGET_VELOCITY]))
        if pdo.controlword is not None:
            self._on_controlword(received[pdo.controlword])

    def _is_whole(self, data: bytes) -> bool:
        """Return whether a command bears the check of this drive and of one of the newest SYNCs."""
        command, check = data[:-2], int.from_bytes(data[-2:], "little")
        if check == check_of(command, self.node_id, self.counter):  # nearly always
            return True
        before = [count_before(self.counter, age) for age in range(OLDEST_COMMAND + 1)]
        return any(check == check_of(command, self.node_id, counter) for counter in before)

    def _on_controlword(self, word: int) -> None:
        before = self.state
        if before == ENABLED and word == self._previous_word == _GO_ON:
            return
        self.state = next_state(self.state, word, self._previous_word)
        self._previous_word = word
        if self.torque_off and self.state != FAULT:
            self.state = SWITCH_ON_DISABLED
        if before == FAULT and self.state != FAULT:
            self.node.values[od.ERROR_REGISTER] = 0
            self.emergency(0)
            if self.torque_off:
                self.emergency(SAFE_TORQUE_OFF)

    # Faults.

    def emergency(self, code: int) -> None:
        """Send an EMCY without a fault."""
        self._send(
            pack_frame(od.EMCY_BASE + self.node_id, EMCY.pack(code, self.node.values[od.ERROR_REGISTER], bytes(5)))
        )

    def fault(self, code: int) -> None:
        """Brake, then go to FAULT (fault reaction), and say why; a second fault changes nothing."""
        if self.state not in (FAULT, FAULT_REACTION):
            self.node.values[od.ERROR_REGISTER] = 1
            self.state = FAULT_REACTION
            self.emergency(code)

    def take_torque(self, off: bool) -> None:
        """Open the safe torque off input, or close it: the motor has no torque at once, and the drive says so."""
        if off and not self.torque_off:
            self.state, self._demand = FAULT, 0
            self.node.values[od.ERROR_REGISTER] = 1
            self.emergency(SAFE_TORQUE_OFF)
        self.torque_off = off

    def watch(self, now: int) -> None:
        """Look after both heartbeats, the host's and its own."""
        self.check_host(now)
        due, limit = self.node.poll(now), (self.node.values[od.HOST_HEARTBEAT] & 0xFFFF) * 1_000_000
        self.due = min(due, self._heard_host + limit + 1) if limit and self._heard_host is not None else due
        if self.state == ENABLED:
            self.due = min(self.due, self._commanded + self.node.values[od.RPDO_TIMEOUT] * 1_000_000 + 1)

    def check_host(self, now: int) -> None:
        """Watch the host's heartbeat, and its commands to a drive that is enabled, while the dictionary asks for it."""
        patience = self.node.values[od.RPDO_TIMEOUT] * 1_000_000
        if patience and self.state == ENABLED and now - self._commanded > patience:
            self.fault(COMMAND_LOST)
        limit_ms = self.node.values[od.HOST_HEARTBEAT] & 0xFFFF
        if limit_ms and self._heard_host is not None and now - self._heard_host > limit_ms * 1_000_000:
            self._heard_host = None
            if self.node.values[od.ABORT_CONNECTION] == 1 and self.node.operational:
                self.fault(HOST_LOST)

    # The cycle.

    def demand(self, period: float) -> float:
        """Return the velocity demand of the next interval, m/s or rad/s: the target if enabled, else a ramp to zero."""
        self._limited, values = False, self.node.values
        if self.state == ENABLED and self._follows:
            limit, target = self._limit, values[od.TARGET_VELOCITY]
            self._limited = not -limit <= target <= limit
            self._demand = max(-limit, min(limit, target)) if self._limited else target
        elif self._demand:
            step = int(values[od.QUICK_STOP_DECELERATION] * period * 1e6 / self._micro)
            self._demand = max(0, self._demand - step) if self._demand > 0 else min(0, self._demand + step)
        if self.state == FAULT_REACTION and self._demand == 0:
            self.state = FAULT
        moves = echo = self._demand * self.scale.velocity * self._micro
        if self.stray is not None and self.state in (ENABLED, QUICK_STOP, FAULT_REACTION):
            moves = self.stray(moves)
        if self.turned is not None:
            moves = self.turned(moves)
        self._astray = moves - echo
        return moves

    def sample(self, motor: float, load: float, demand: float, effort: float) -> bytes:
        """Take what the plant says at a SYNC, SI units, and return the synchronous TPDOs as frames."""
        demand -= self._astray
        if self.tamper is not None:
            motor, load, demand, effort = self.tamper(AxisReading(motor, load, demand, effort))
        scale = self.scale
        torque = round(effort / scale.effort)
        if not -32768 <= torque <= 32767:
            torque = max(-32768, min(32767, torque))
        self._readings = readings = (
            _wrapped(round(load / scale.load_encoder)),
            self.statusword,
            torque,
            _wrapped(round(motor / scale.motor_encoder)),
            _wrapped(round(demand / scale.velocity)),
        )
        if not (self.powered and self.node.operational):
            return b""
        frames = self._tpdos.frames(readings, self.node.values)
        if self._check_header is None:
            return frames
        said = b"".join([frames[part] for part in self._tpdos.data])
        return frames + self._check_header + _CHECK.pack(check_of(said, self.node_id, self.counter))

    @property
    def statusword(self) -> int:
        """The statusword of this moment."""
        enabled = self.state == ENABLED
        return (
            self.state | _REMOTE | _VOLTAGE * (not self.torque_off) | _FOLLOWS * enabled | _LIMIT_ACTIVE * self._limited
        ) ^ self.misstates
