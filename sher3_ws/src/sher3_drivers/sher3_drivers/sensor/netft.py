"""ATI NetFT over RDT ("raw data transfer"): UDP requests of 8 bytes, records of 36 bytes, big-endian.

ATI 9620-05-NET FT manual, "UDP interface using RDT". The same back-end reads the mock sensor, which speaks the same
records (`netft_server`). The reading of the tick t_k is the newest record that arrived at t_k or later. The kernel
notes the times of arrival, so a late record is never taken for one of the next tick.
"""

from __future__ import annotations

import contextlib
import select
import socket
import struct
import time
from collections.abc import Callable
from typing import NamedTuple

from sher3_common.vectors import Wrench
from sher3_common.waiting import wait_readable

from sher3_drivers.errors import DeviceMissing
from sher3_drivers.sensor.device import WrenchRecord

PORT = 49152
"""UDP port of the device."""
REQUEST = struct.Struct(">HHI")
"""Header, command, number of samples (0: without end)."""
RECORD = struct.Struct(">III6i")
"""RDT sequence, FT sequence, status, and the counts of fx, fy, fz, mx, my, mz."""
HEADER = 0x1234
STOP, STREAM, SET_BIAS = 0x0000, 0x0002, 0x0042
"""Commands of a request."""
_RETRY, _PAUSE = 0.1, 0.02
"""Longest wait for the answer to one request of the start, and the pause before the next, s."""
_LEAST, _MOST = -(2**31), 2**31 - 1
"""What 32 bits hold."""
_MOST_BYTES = 64
"""Bytes taken of a datagram: more than a record, so that a longer one shows as a misfit."""
_SO_TIMESTAMPNS = getattr(socket, "SO_TIMESTAMPNS", 35)
_TIMESPEC = struct.Struct("@ll")


class NetFtScale(NamedTuple):
    """Counts per unit, from the calibration on the device's web page.

    Attributes:
        counts_per_newton: 1/N; by default that of the Nano17.
        counts_per_newton_metre: 1/(N m); the calibration gives it per N mm.
    """

    counts_per_newton: float = 1e6
    counts_per_newton_metre: float = 1e9

    def to_wrench(self, counts: tuple[int, ...]) -> Wrench:
        """Return the wrench of six counts, N and N m in the sensor frame."""
        f, t = self.counts_per_newton, self.counts_per_newton_metre
        fx, fy, fz, mx, my, mz = counts
        return fx / f, fy / f, fz / f, mx / t, my / t, mz / t

    def to_counts(self, wrench: Wrench) -> tuple[int, ...]:
        """Return the six counts nearest to a wrench, limited to 32 bits; a NaN becomes the most negative count."""
        f, t = self.counts_per_newton, self.counts_per_newton_metre
        values = [w * s for w, s in zip(wrench, (f, f, f, t, t, t), strict=True)]
        return tuple([round(v) if _LEAST <= v <= _MOST else _MOST if v > _MOST else _LEAST for v in values])


class NetFtSensor:
    """A NetFT box, or the mock that speaks like one.

    Args:
        address: (host, port) of the device.
        clock: the driver's time in ns.
        scale: counts per unit.
        answer_limit: longest wait for the first record, s.

    Attributes:
        misfits: number of datagrams that were no record; they are not taken.

    Raises:
        DeviceMissing: nothing answers at that address.
    """

    def __init__(
        self,
        address: tuple[str, int],
        clock: Callable[[], int] = time.monotonic_ns,
        scale: NetFtScale | None = None,
        answer_limit: float = 10.0,
    ) -> None:
        self.name = f"netft {address[0]}:{address[1]}"
        self._clock = clock
        self._scale = scale or NetFtScale()
        self._drained = 0
        self.misfits = 0
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
        try:
            self._socket.connect(address)
            self._start(answer_limit)
        except OSError as error:
            self._socket.close()
            raise self._missing(str(error)) from error

    def _start(self, limit: float) -> None:
        """Ask for the stream until it comes: the device may be starting."""
        self._socket.setblocking(False)
        deadline = time.monotonic() + limit
        while time.monotonic() < deadline:
            with contextlib.suppress(ConnectionRefusedError):
                self._socket.send(REQUEST.pack(HEADER, STREAM, 0))
                if select.select((self._socket,), (), (), _RETRY)[0] and self._newest(0) is not None:
                    return
            time.sleep(_PAUSE)
        self._socket.close()
        raise self._missing(f"no record within {limit:g} s")

    def _missing(self, what: str) -> DeviceMissing:
        return DeviceMissing(self.name, what, remedy="check power, cable and address, or run with --mock")

    def read(self, since: int, timeout: float) -> WrenchRecord | None:
        """Return the newest record that arrived at or after `since`; see `sensor.device.ForceSensorDevice`."""
        deadline = time.monotonic() + timeout
        while (record := self._newest(since)) is None and (left := deadline - time.monotonic()) > 0.0:
            wait_readable((self._socket.fileno(),), left)
        return record

    def _newest(self, since: int) -> WrenchRecord | None:
        """Take every waiting record; return the newest one, unless it arrived before `since` (ns)."""
        newest: WrenchRecord | None = None
        try:
            while True:
                data, ancillary, _, _ = self._socket.recvmsg(_MOST_BYTES, _MOST_BYTES)
                if len(data) != RECORD.size:
                    self.misfits += 1
                    continue
                sequence, _, status, *counts = RECORD.unpack(data)
                self._drained += 1
                if self._arrival(ancillary) >= since:
                    newest = WrenchRecord(self._scale.to_wrench(tuple(counts)), sequence, status, self._drained)
        except BlockingIOError:
            pass
        except OSError as error:
            raise self._missing(f"lost: {error}") from error
        if newest is not None:
            self._drained = 0
        return newest

    def _arrival(self, ancillary: list[tuple[int, int, bytes]]) -> int:
        """Return when a record arrived, ns of the driver's clock; when the kernel does not say, that is now."""
        now = self._clock()
        for level, kind, data in ancillary:
            if level == socket.SOL_SOCKET and kind == _SO_TIMESTAMPNS:
                seconds, nanoseconds = _TIMESPEC.unpack_from(data)
                return now - (time.time_ns() - seconds * 1_000_000_000 - nanoseconds)
        return now

    def close(self) -> None:
        """Stop the stream."""
        with contextlib.suppress(OSError):
            self._socket.send(REQUEST.pack(HEADER, STOP, 0))
        self._socket.close()
