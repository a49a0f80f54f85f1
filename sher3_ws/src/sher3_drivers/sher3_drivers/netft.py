"""ATI NetFT over RDT ("raw data transfer"): UDP requests of 8 bytes, records of 36 bytes, big-endian.

ATI 9620-05-NET FT manual, "UDP interface using RDT". The same back-end reads the mock sensor, which speaks the same
records (`netft_server`). A record is a reading of the tick t_k when it is the newest that arrived at or after t_k;
the kernel's arrival times tell, so a late record is never taken for the next tick's.
"""

from __future__ import annotations

import contextlib
import select
import socket
import struct
import time
from collections.abc import Callable
from typing import NamedTuple

from .errors import DeviceMissing
from .force_sensor import Wrench, WrenchRecord

PORT = 49152
REQUEST = struct.Struct(">HHI")
RECORD = struct.Struct(">III6i")
HEADER = 0x1234
STOP, STREAM, SET_BIAS = 0x0000, 0x0002, 0x0042
_SO_TIMESTAMPNS = getattr(socket, "SO_TIMESTAMPNS", 35)
_TIMESPEC = struct.Struct("@ll")


class NetFtScale(NamedTuple):
    """Counts per unit, from the calibration shown on the device's web page; the Nano17's are per N and per N mm."""

    counts_per_newton: float = 1e6
    counts_per_newton_metre: float = 1e9

    def to_wrench(self, counts: tuple[int, ...]) -> Wrench:
        """Return (fx, fy, fz, mx, my, mz) in N and N m."""
        f, t = self.counts_per_newton, self.counts_per_newton_metre
        fx, fy, fz, mx, my, mz = counts
        return fx / f, fy / f, fz / f, mx / t, my / t, mz / t

    def to_counts(self, wrench: Wrench) -> tuple[int, ...]:
        """Return the counts nearest to a wrench, held within 32 bits; a NaN becomes the most negative count."""
        f, t = self.counts_per_newton, self.counts_per_newton_metre
        values = [w * s for w, s in zip(wrench, (f, f, f, t, t, t), strict=True)]
        return tuple([-(2**31) if v != v else round(max(-(2.0**31), min(2.0**31 - 1, v))) for v in values])


class NetFtSensor:
    """A NetFT box, or the mock that speaks like one.

    Args:
        address: (host, port) of the device.
        clock: the driver's time in ns.
        scale: counts per unit.
        answer_limit: longest wait for the first record, s.

    Attributes:
        misfits: datagrams that were no record, never taken.

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
        """Ask for the stream until it comes; the device may be starting."""
        self._socket.setblocking(False)
        deadline = time.monotonic() + limit
        while time.monotonic() < deadline:
            with contextlib.suppress(ConnectionRefusedError):
                self._socket.send(REQUEST.pack(HEADER, STREAM, 0))
                if select.select((self._socket,), (), (), 0.1)[0] and self._newest(0) is not None:
                    return
            time.sleep(0.02)
        self._socket.close()
        raise self._missing(f"no record within {limit:g} s")

    def _missing(self, what: str) -> DeviceMissing:
        return DeviceMissing(self.name, what, remedy="check power, cable and address, or run with --mock")

    def read(self, since: int, timeout: float) -> WrenchRecord | None:
        """Return the newest record that arrived at or after `since`; see `force_sensor.ForceSensorDevice`."""
        deadline = time.monotonic() + timeout
        while True:
            select.select((self._socket,), (), (), max(0.0, deadline - time.monotonic()))
            record = self._newest(since)
            if record is not None or time.monotonic() >= deadline:
                return record

    def _newest(self, since: int) -> WrenchRecord | None:
        """Take every waiting record; return the newest if it arrived at or after `since`."""
        newest: WrenchRecord | None = None
        try:
            while True:
                data, ancillary, _, _ = self._socket.recvmsg(64, 64)
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
        """Return when a record arrived, on the driver's clock; now when the kernel does not say."""
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
