"""A pedal whose device end is another process of this user: datagrams with the whole state, on a private socket."""

from __future__ import annotations

import socket
import struct
import time
from collections.abc import Callable

from sher3_drivers.errors import DeviceMissing
from sher3_drivers.pedal.device import AGE_LIMIT, PedalState, PedalTamper, wired
from sher3_drivers.runtime_directory import runtime_directory

_DATAGRAM = struct.Struct("<d???")
"""Travel, emergency stop and the two contacts."""
_MOST_BYTES = 64
"""Bytes taken of a datagram: more than one state has, so that a longer one is not taken for it."""


class LocalPedal:
    """A pedal whose device end is another process of this user: datagrams with the whole state, on a private socket.

    Args:
        name: name of the pedal; `PedalSender` uses the same.
        age_limit: longest silence once something was heard, s.
        clock: time in ns.

    Attributes:
        path: the socket.
    """

    def __init__(
        self, name: str = "pedal", age_limit: float = AGE_LIMIT, clock: Callable[[], int] = time.monotonic_ns
    ) -> None:
        self.name = f"local pedal {name}"
        self._limit_ns, self._clock = round(age_limit * 1e9), clock
        self._state: PedalState | None = None
        self._heard_at = 0
        self.path = runtime_directory() / f"{name}.pedal"
        self.path.unlink(missing_ok=True)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        self._socket.bind(str(self.path))

    def read(self) -> PedalState | None:
        """Return the present state; see `PedalDevice`."""
        try:
            while True:
                data = self._socket.recv(_MOST_BYTES)
                if len(data) == _DATAGRAM.size:
                    self._state = PedalState(*_DATAGRAM.unpack(data))
                    self._heard_at = self._clock()
        except BlockingIOError:
            pass
        silence = self._clock() - self._heard_at
        if self._state is not None and silence > self._limit_ns:
            limit = f"{self._limit_ns * 1e-9:g} s"
            raise DeviceMissing(self.name, "fell silent", value=f"{silence * 1e-9:.3f} s", limit=limit)
        return self._state

    def close(self) -> None:
        """Remove the socket."""
        self._socket.close()
        self.path.unlink(missing_ok=True)


class PedalSender:
    """The device end of a LocalPedal.

    Attributes:
        tamper: takes a state and returns those that are sent: none, one or more. The seam for injected faults.
    """

    def __init__(self, name: str = "pedal") -> None:
        self.tamper: PedalTamper | None = None
        self._path = str(runtime_directory() / f"{name}.pedal")
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)

    def send(self, state: PedalState) -> bool:
        """Send the state; return False when nobody takes it, which does no harm."""
        try:
            for sent in [wired(state)] if self.tamper is None else self.tamper(wired(state)):
                self._put(_DATAGRAM.pack(*sent))
        except OSError:
            return False
        return True

    def _put(self, datagram: bytes) -> None:
        """Put one datagram on the line, which is sought anew when nobody is at its end, or somebody else."""
        try:
            self._socket.send(datagram)
        except OSError:
            self._socket.connect(self._path)
            self._socket.send(datagram)

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()
