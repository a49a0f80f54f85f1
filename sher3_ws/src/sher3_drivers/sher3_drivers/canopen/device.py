"""A CANopen node of a mock drive: dictionary, SDO server, NMT and heartbeat by `canopen`, without threads."""

from __future__ import annotations

import struct
from collections.abc import Callable

import canopen
from canopen.node import LocalNode
from canopen.sdo import SdoAbortedError

from sher3_drivers.bus.frame import pack_frame
from sher3_drivers.canopen.dictionary import drive_dictionary
from sher3_drivers.canopen.objects import OBJECTS, Address

_NO_OBJECT = 0x06020000


class _PolledTask:
    """A periodic message sent by `poll`, in place of the library's threads."""

    def __init__(self, tasks: list[_PolledTask], can_id: int, data: list[int], period: float) -> None:
        self._tasks, self.can_id, self.data, self.period_ns = tasks, can_id, bytes(data), round(period * 1e9)
        self.due: int | None = None
        tasks.append(self)

    def update(self, data: list[int]) -> None:
        self.data = bytes(data)

    def stop(self) -> None:
        if self in self._tasks:
            self._tasks.remove(self)


class _NodeNetwork(canopen.Network):
    def __init__(self, send: Callable[[bytes], None]) -> None:
        super().__init__()
        self._send = send
        self.tasks: list[_PolledTask] = []

    def send_message(self, can_id: int, data: bytes, remote: bool = False) -> None:
        del remote
        self._send(pack_frame(can_id, bytes(data)))

    def send_periodic(self, can_id: int, data: list[int], period: float, remote: bool = False) -> _PolledTask:  # type: ignore[override]
        del remote
        return _PolledTask(self.tasks, can_id, data, period)


class CanopenDevice:
    """One node.

    Args:
        node_id: 1 to 127.
        send: takes whole frames.
        factory: value of every object after power-up or reset.
        on_write: called with (address, value) before an SDO write takes effect.
        on_reset: called after an NMT reset.

    Attributes:
        values: every object as it is now.
        factory: every object as it is after a reset.
        operational: whether PDOs are served.
        missing: objects that this node does not have.
    """

    OPERATIONAL = "OPERATIONAL"

    def __init__(
        self,
        node_id: int,
        send: Callable[[bytes], None],
        factory: dict[Address, int],
        on_write: Callable[[Address, int], None],
        on_reset: Callable[[], None],
    ) -> None:
        self.values = dict(factory)
        self.operational = False
        self.missing: frozenset[Address] = frozenset()
        self.factory = dict(factory)
        self._on_write, self._on_reset = on_write, on_reset
        self._network = _NodeNetwork(send)
        self._node = LocalNode(node_id, drive_dictionary())
        self._node.add_read_callback(self._read)
        self._node.add_write_callback(self._write)
        self._node.associate_network(self._network)
        self._boot()

    def _boot(self) -> None:
        """Enter INITIALISING, say so with the boot-up message, and go on to PRE-OPERATIONAL."""
        self.values.update(self.factory)
        self.operational = False
        self._node.nmt.stop_heartbeat()
        self._node.nmt.state = "INITIALISING"
        self._node.nmt.state = "PRE-OPERATIONAL"

    def _read(self, index: int, subindex: int, od: object) -> int:
        del od
        return self.values[self._address(index, subindex)]

    def _address(self, index: int, subindex: int) -> Address:
        """Return the address of an object that is there."""
        address = Address(index, subindex)
        if address in self.missing:
            raise SdoAbortedError(_NO_OBJECT)
        return address

    def _write(self, index: int, subindex: int, od: object, data: bytes) -> None:
        del od
        address = self._address(index, subindex)
        value = OBJECTS[address].unpack(data)
        self._on_write(address, value)
        self.values[address] = value

    def write(self, address: Address, value: int) -> None:
        """Take a value as an SDO download does, without its frames."""
        self._node.set_data(address.main, address.sub, OBJECTS[address].pack(value))

    def handle(self, can_id: int, data: bytes) -> None:
        """Serve an SDO request or NMT command; anything malformed is ignored, as a node on the bus does."""
        if can_id and len(data) != 8:
            return
        try:
            self._network.notify(can_id, bytearray(data), 0.0)
        except (struct.error, TypeError):
            return
        if self._node.nmt.state == "INITIALISING":
            self._boot()
            self._on_reset()
        operational = self._node.nmt.state == self.OPERATIONAL
        if operational != self.operational:
            self.operational = operational
            for task in self._network.tasks:  # say so at once, not a heartbeat later
                self._network.send_message(task.can_id, task.data)

    def poll(self, now: int) -> int:
        """Send the heartbeat when it is due; return when the next one is, by default in a second. Times in ns."""
        for task in self._network.tasks:
            if task.due is None or now >= task.due:
                self._network.send_message(task.can_id, task.data)
                task.due = now + task.period_ns
        return min([task.due for task in self._network.tasks if task.due is not None], default=now + 1_000_000_000)
