"""Injects faults into the device ends that the plant process holds, at run time, over the frames of the real ones.

Seams are closed while nothing is wrong, so a healthy run costs nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from random import Random
from typing import NamedTuple, Protocol

from sher3_description import ACTUATORS
from sher3_drivers.bus.frame import FRAME_SIZE
from sher3_drivers.canopen import objects as od
from sher3_drivers.canopen.cia402 import Controlword
from sher3_drivers.mock.bus import MockDriveBus
from sher3_drivers.mock.drive import AxisReading, MockDrive
from sher3_drivers.pedal.device import PedalState
from sher3_drivers.sensor.device import WrenchRecord

from sher3_faults.errors import FaultRefused
from sher3_faults.items import BusFrames, Columns, DriveFrames, Numbers, PedalStates, WrenchRecords
from sher3_faults.kinds import KINDS, OFF, OK, Items, Kind
from sher3_faults.requests import DEVICES, GROUPS, PLUGS, RESETS, WIRES, FaultRequest, parse_request

_UP, _DOWN = "up", "down"
_TORQUE = "safe_torque_off"
_NO_LINES = ("force_sensor", "pedal", _TORQUE, WIRES)
"""Components without frames."""


class ForceEnd(Protocol):
    """The force sensor's device end."""

    tamper: Callable[[WrenchRecord], list[WrenchRecord]] | None


class PedalEnd(Protocol):
    """The pedal's device end."""

    tamper: Callable[[PedalState], list[PedalState]] | None


class Active(NamedTuple):
    """A requested fault; it acts from `begin` to `end` [ns].

    Attributes:
        ways: directions of a line that it acts on.
        kinds: the fault of each stream so far, by a name of that stream.
    """

    request: FaultRequest
    begin: int
    end: int | None
    ways: tuple[str, ...]
    kinds: dict[str, Kind]

    def acts(self, now: int) -> bool:
        """Whether it acts at `now`."""
        return self.begin <= now and (self.end is None or now < self.end)

    def kind(self, stream: str, items: Items) -> Kind:
        """Return the fault of one stream: what waits on one never comes out of another."""
        if stream not in self.kinds:
            make, random = KINDS[self.request.fault], Random(f"{self.request.seed} {stream}")
            self.kinds[stream] = make(items, self.request.parameters, random)
        return self.kinds[stream]


class FaultInjector:
    """Faults of drives, bus, sensor and pedal of one plant process.

    Args:
        drives, force, pedal: the device ends.
        clock: time in ns.

    Attributes:
        active: the requested faults by component; a new request for a component replaces the old one.
        refused: the newest refusal, None after a request that was taken.
    """

    def __init__(
        self, drives: MockDriveBus, force: ForceEnd, pedal: PedalEnd, clock: Callable[[], int] | None = None
    ) -> None:
        self.active: dict[str, Active] = {}
        self.refused: str | None = None
        self._drives, self._force, self._pedal = drives, force, pedal
        self._clock = clock or drives.clock
        self._held: dict[str, float] = {}

    def take(self, text: str, now: int) -> FaultRequest:
        """Take a request as it came on `mock/fault` at `now` [ns].

        Raises:
            FaultRefused: it names what does not exist; nothing changes.
        """
        try:
            request = parse_request(text)
            self._check_channel(request)
        except FaultRefused as error:
            self.refused = str(error)
            raise
        self.refused = None
        if request.fault == OK:
            for name in list(self.active) if request.component == "all" else [request.component]:
                self.active.pop(name, None)
        elif request.component in DEVICES:
            begin = now + round(request.start * 1e9)
            end = None if request.duration is None else begin + round(request.duration * 1e9)
            _, _, part = request.component.partition(".")
            self.active[request.component] = Active(request, begin, end, (part,) if part else (_UP, _DOWN), {})
            self._held.clear()
        self._connect()
        return request

    def poll(self, now: int) -> None:
        """End the faults whose time is over; switch drives on and off, which is no change of a stream."""
        for name, drive in self._drives.drives.items():
            self._act_on_drive(name, drive, now)
        line = self.active.get(_TORQUE)
        self._drives.safe_torque_off(line is not None and line.acts(now))
        over = [name for name, active in self.active.items() if active.end is not None and now >= active.end]
        for name in over:
            del self.active[name]
        if over:
            self._connect()

    def _act_on_drive(self, name: str, drive: MockDrive, now: int) -> None:
        """Take a whole drive off the line, deaf to SYNC and heartbeat too, or let it find an error in itself.

        Or let it misstate itself: the bits of `code` in its statusword are the other way.
        """
        line, inside = self.active.get(name), self.active.get(f"{name}.demand")
        says = self.active.get(f"{name}.statusword")
        drive.misstates = int(says.request.parameters.get("code", 0)) if says is not None and says.acts(now) else 0
        drive.powered = line is None or line.request.fault != OFF or not line.acts(now)
        if inside is not None and inside.acts(now) and (code := int(inside.request.parameters.get("code", 0))):
            drive.fault(code)

    def report(self) -> tuple[int, str, tuple[tuple[str, str], ...]]:
        """Return level, sentence and values for `/diagnostics`."""
        values = tuple((name, active.request.fault) for name, active in self.active.items())
        if self.refused is not None:
            return 1, self.refused, values
        if not values:
            return 0, "everything is well", ()
        return 1, "broken: " + ", ".join(f"{name} {fault}" for name, fault in values), values

    def _check_channel(self, request: FaultRequest) -> None:
        unit = request.component.partition(".")[0]
        if unit.startswith("bus") and unit[3:] and int(unit[3:]) >= len(self._drives.links):
            limit = f"bus0 to bus{len(self._drives.links) - 1}"
            raise FaultRefused(request.component, request.fault, "no such channel", value=unit, limit=limit)

    def _numbers(self, unit: str, part: str) -> Numbers:
        """Return what the numbers of one part are: positions, velocities, or the shares of a pedal."""
        if unit == "pedal":
            return Numbers(1.0)
        return Numbers(0.05 if "encoder" in part else self._drives.drives[unit].scale.velocity_limit)

    def _faulty(self, name: str, *parts: str) -> bool:
        """Whether a fault of one of these parts of an axis was asked for, alone or with others."""
        return any(f"{unit}.{part}" in self.active for unit in _units(name) for part in parts)

    # The seams.

    def _connect(self) -> None:
        """Open the seams that are needed and close the others."""
        names = self.active
        self._force.tamper = self._record if "force_sensor" in names else None
        pedal = {"pedal", "pedal.travel", "pedal.contact"} & names.keys()
        self._pedal.tamper = self._foot if pedal else None
        self._drives.crossed = self._crossed if names.keys() & PLUGS.keys() else None
        for name, drive in self._drives.drives.items():
            says = self._faulty(name, "load_encoder", "motor_encoder", "encoders", "echo")
            drive.tamper = self._feedback(name) if says else None
            drive.mistake = partial(self._demand, name) if self._faulty(name, "demand") else None
            drive.stray = partial(self._number, name, "power") if self._faulty(name, "power") else None
            drive.turned = partial(self._number, name, "motor") if self._faulty(name, "motor") else None
        parts = [name.partition(".")[::2] for name in names if name not in _NO_LINES]
        up = any(part in ("", _UP) for _, part in parts)
        down = any(part in ("", _DOWN, RESETS) for _, part in parts)
        self._drives.tamper_frames = self._frames(_UP) if up else None
        self._drives.tamper_received = self._frames(_DOWN) if down else None

    def _record(self, record: WrenchRecord) -> list[WrenchRecord]:
        """Return the records of the force sensor as a fault leaves them."""
        active, now = self.active["force_sensor"], self._clock()
        return active.kind("", WrenchRecords())([record], now) if active.acts(now) else [record]

    def _crossed(self, column: str, values: Sequence[float]) -> Sequence[float]:
        """Return a column of all axes as exchanged plugs leave it."""
        now = self._clock()
        for plug, columns in PLUGS.items():
            active = self.active.get(plug)
            if active is not None and column in columns and active.acts(now):
                (values,) = active.kind(column, Columns())([values], now)
        return values

    def _foot(self, state: PedalState) -> list[PedalState]:
        """Return the states of the pedal as faults of its travel, of its contact, and of its line leave them."""
        travel = self._number("pedal", "travel", state.travel)
        made = bool(round(self._number("pedal", "contact", float(bool(state.made)))))
        states = [state._replace(travel=travel, made=made)]
        active, now = self.active.get("pedal"), self._clock()
        if active is None or not active.acts(now):
            return states
        return active.kind("", PedalStates())(states, now)

    def _feedback(self, name: str) -> Callable[[AxisReading], AxisReading]:
        def tamper(feedback: AxisReading) -> AxisReading:
            motor = self._number(name, "motor_encoder", feedback.motor_position)
            load = self._number(name, "load_encoder", feedback.load_position)
            return feedback._replace(
                motor_position=self._number(name, "encoders", motor, " motor"),
                load_position=self._number(name, "encoders", load, " load"),
                velocity_demand=self._number(name, "echo", feedback.velocity_demand),
            )

        return tamper

    def _demand(self, name: str, counts: float) -> float:
        limit, scale = 2**31 - 1, self._drives.drives[name].scale.velocity
        return max(-limit, min(limit, self._number(name, "demand", counts * scale) / scale))

    def _number(self, name: str, part: str, value: float, which: str = "") -> float:
        """Return a number as faults leave it; a number that a fault drops keeps its last value.

        `which` tells numbers apart that are of one part.
        """
        now, stream = self._clock(), f"{name}.{part}{which}"
        for unit in _units(name):
            active = self.active.get(f"{unit}.{part}")
            if active is not None and active.acts(now):
                passed = active.kind(stream, self._numbers(name, part))([value], now)
                value = passed[-1] if passed else self._held.get(stream, value)
        self._held[stream] = value
        return value

    def _frames(self, way: str) -> Callable[[int, bytes, int], bytes]:
        def tamper(channel: int, frames: bytes, now: int) -> bytes:
            items = [frames[i : i + FRAME_SIZE] for i in range(0, len(frames), FRAME_SIZE)]
            for component, active in list(self.active.items()):
                unit = component.partition(".")[0]
                if unit in _NO_LINES or not active.acts(now):
                    continue
                if way == _DOWN and RESETS in active.ways:
                    items = [item for item in items if not _resets(item, self._drives.drives[unit])]
                elif way in active.ways and unit in ("bus", f"bus{channel}"):
                    items = self._of_bus(active, way, channel, items, now)
                elif way in active.ways and unit in ACTUATORS:
                    items = self._of_drive(unit, channel, active.kind(way, DriveFrames()), items, now)
            return b"".join(items)

        return tamper

    def _of_bus(self, active: Active, way: str, channel: int, items: list[bytes], now: int) -> list[bytes]:
        """Let the fault act on all frames of a channel; a SYNC twice would be a step of the plant too many."""
        fault = active.kind(f"{way} {channel}", BusFrames())
        if active.request.fault not in ("duplicated", "reordered", "contradicted"):
            return fault(items, now)
        passed: list[bytes] = []
        for item in items:
            passed += [item] if int.from_bytes(item[:4], "little") == od.SYNC_ID else fault([item], now)
        return passed

    def _of_drive(self, name: str, channel: int, fault: Kind, items: list[bytes], now: int) -> list[bytes]:
        """Let the fault act on the frames of one drive, in their place among the others."""
        drive = self._drives.drives[name]
        if drive not in self._drives.on_channel(channel):
            return items
        passed: list[bytes] = []
        for item in items:
            passed += fault([item], now) if _concerns(item, drive) else [item]
        return passed + fault([], now)


def _units(name: str) -> tuple[str, ...]:
    """Return an axis and the groups that it is in."""
    return (name, *(group for group, axes in GROUPS.items() if name in axes))


def _concerns(item: bytes, drive: MockDrive) -> bool:
    """Whether a frame is of one drive and no other: SYNC and NMT belong to all."""
    can_id = int.from_bytes(item[:4], "little")
    return can_id not in (od.SYNC_ID, od.NMT_ID) and can_id & 0x7F == drive.node_id


def _resets(item: bytes, drive: MockDrive) -> bool:
    """Whether a frame asks a drive to leave FAULT; no two drives have the same node id."""
    can_id = int.from_bytes(item[:4], "little")
    return can_id == od.RPDO_BASE + drive.node_id and item[8] == Controlword.FAULT_RESET.value
