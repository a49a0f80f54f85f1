"""The device end of a NetFT: the mock force sensor of the plant process, on the loopback unless told otherwise."""

from __future__ import annotations

import socket
from collections.abc import Callable, Sequence

from sher3_common.vectors import Wrench

from sher3_drivers.errors import DeviceMissing
from sher3_drivers.sensor.device import WrenchRecord
from sher3_drivers.sensor.netft import HEADER, PORT, RECORD, REQUEST, SET_BIAS, STOP, STREAM, NetFtScale

RecordTamper = Callable[[bytes], bytes]
WrenchTamper = Callable[[WrenchRecord], list[WrenchRecord]]


class NetFtServer:
    """A mock NetFT: it streams to the client that asked last, as the device does.

    Args:
        address: where to listen; port 0 takes a free one.
        scale: counts per unit.

    Attributes:
        address: where it listens.
        client: who gets the stream, None while nobody asked for it.
        status: status word of the next records.
        tamper_bytes: takes a record on its way out and returns the bytes that are sent; b"" loses it.
        tamper: takes a reading and returns those that are sent: none, one or more. The seam for injected faults.

    Raises:
        DeviceMissing: the port is taken.
    """

    def __init__(self, address: tuple[str, int] = ("127.0.0.1", PORT), scale: NetFtScale | None = None) -> None:
        self.status = 0
        self.tamper_bytes: RecordTamper | None = None
        self.tamper: WrenchTamper | None = None
        self._scale = scale or NetFtScale()
        self.client: tuple[str, int] | None = None
        self._sequence = 0
        self._bias: tuple[int, ...] = (0,) * 6
        self._counts: tuple[int, ...] = (0,) * 6
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._socket.bind(address)
        except OSError as error:
            self._socket.close()
            remedy = "end the other process or use another port"
            raise DeviceMissing(f"mock netft {address[0]}:{address[1]}", str(error), remedy=remedy) from error
        self.address: tuple[str, int] = self._socket.getsockname()

    def fileno(self) -> int:
        """Return the socket's descriptor: readable when a request waits."""
        return self._socket.fileno()

    def poll(self) -> None:
        """Serve every request that waits; other datagrams are ignored."""
        try:
            while True:
                data, client = self._socket.recvfrom(64)
                if len(data) == REQUEST.size:
                    header, command, _ = REQUEST.unpack(data)
                    if header == HEADER:
                        self._serve(command, client)
        except (BlockingIOError, ConnectionRefusedError):
            return

    def _serve(self, command: int, client: tuple[str, int]) -> None:
        if command == STREAM:
            self.client = client
            self._send()
        elif command == STOP and client == self.client:
            self.client = None
        elif command == SET_BIAS:
            self._bias = self._counts

    def publish(self, wrench: Wrench) -> None:
        """Take a new reading, N and N m in the sensor frame {f}, and send it to the client, if there is one."""
        self._counts = self._scale.to_counts(wrench)
        self._sequence = self._sequence + 1 & 0xFFFFFFFF
        self._send()

    def _send(self) -> None:
        if self.client is None:
            return
        counts: Sequence[int] = self._counts
        if any(self._bias):
            counts = [max(-(2**31), min(2**31 - 1, c - b)) for c, b in zip(counts, self._bias, strict=True)]
        if self.tamper is None:
            self._put(RECORD.pack(self._sequence, self._sequence, self.status, *counts))
            return
        for reading in self.tamper(WrenchRecord(self._scale.to_wrench(tuple(counts)), self._sequence, self.status)):
            sequence = reading.sequence
            self._put(RECORD.pack(sequence, sequence, reading.status, *self._scale.to_counts(reading.wrench)))

    def _put(self, record: bytes) -> None:
        """Put one datagram on the line."""
        if self.tamper_bytes is not None:
            record = self.tamper_bytes(record)
        if record and self.client is not None:
            try:
                self._socket.sendto(record, self.client)
            except ConnectionRefusedError:
                self.client = None
            except BlockingIOError:
                pass

    def close(self) -> None:
        """Stop listening."""
        self._socket.close()
