"""The foot pedal: travel 0 to 1 and an emergency stop, from a Linux joystick device, another process, or this one.

A pedal that is missing or lost is an error, never a released pedal nobody notices: the last state is not repeated
for ever.
"""

from __future__ import annotations

import contextlib
import math
import os
import socket
import struct
import time
from collections.abc import Callable
from typing import NamedTuple, Protocol

from .bus_local import runtime_directory
from .errors import DeviceMissing

JS_EVENT = struct.Struct("<IhBB")
"""struct js_event of linux/joystick.h: time [ms], value, type, number."""

_BUTTON, _AXIS, _INIT = 0x01, 0x02, 0x80
_FULL = 32767
_DATAGRAM = struct.Struct("<d?")


class PedalState(NamedTuple):
    """`travel` from 0 (released) to 1, and whether the emergency stop is pressed."""

    travel: float
    emergency_stop: bool


PedalTamper = Callable[[PedalState], list[PedalState]]
AGE_LIMIT = 0.02
"""Longest silence of a pedal that says its whole state again and again, s: 100 um at the tip's 5 mm/s."""


class PedalDevice(Protocol):
    """A pedal back-end."""

    def read(self) -> PedalState | None:
        """Return the present state, None when the pedal has not said anything yet.

        Raises:
            DeviceMissing: the pedal is gone or has been silent for too long.
        """

    def close(self) -> None:
        """Let the device go."""


class JoystickPedal:
    """A pedal on the Linux joystick interface.

    The kernel tells the state at opening and every change afterwards; an unplugged device makes the next read fail.

    Args:
        path: device, as in /dev/input/js0.
        axis: number of the travel axis; -32767 is released.
        button: number of the emergency stop button.
    """

    def __init__(self, path: str = "/dev/input/js0", axis: int = 0, button: int = 0) -> None:
        self.name = f"pedal {path}"
        self._axis, self._button = axis, button
        self._travel: float | None = None
        self._stop = False
        try:
            self._fd = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        except OSError as error:
            remedy = "plug it in and check the permissions, name another device, or run with --mock"
            raise DeviceMissing(self.name, error.strerror or str(error), remedy=remedy) from error

    def read(self) -> PedalState | None:
        """Return the present state; see `PedalDevice`."""
        try:
            while True:
                data = os.read(self._fd, 64 * JS_EVENT.size)
                if not data:
                    raise DeviceMissing(self.name, "was unplugged", remedy="plug it in and restart")
                self._take(data)
        except BlockingIOError:
            pass
        except OSError as error:
            raise DeviceMissing(self.name, f"was lost: {error.strerror}", remedy="plug it in and restart") from error
        return None if self._travel is None else PedalState(self._travel, self._stop)

    def _take(self, data: bytes) -> None:
        for _, value, kind, number in JS_EVENT.iter_unpack(data[: len(data) // JS_EVENT.size * JS_EVENT.size]):
            if kind & ~_INIT == _AXIS and number == self._axis:
                self._travel = (max(-_FULL, value) + _FULL) / (2 * _FULL)
            elif kind & ~_INIT == _BUTTON and number == self._button:
                self._stop = bool(value)

    def close(self) -> None:
        """Close the device; closing twice is allowed."""
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1


class LocalPedal:
    """A pedal whose device end is another process of this user: datagrams with the whole state, on a private socket.

    Args:
        name: name of the pedal; `PedalSender` uses the same.
        age_limit: longest silence, s, once something was heard.
        clock: time in ns.
    """

    def __init__(
        self, name: str = "pedal", age_limit: float = AGE_LIMIT, clock: Callable[[], int] = time.monotonic_ns
    ) -> None:
        self.name = f"local pedal {name}"
        self._limit_ns, self._clock = round(age_limit * 1e9), clock
        self._state: PedalState | None = None
        self._heard_at = 0
        self._path = runtime_directory() / f"{name}.pedal"
        self._path.unlink(missing_ok=True)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        self._socket.bind(str(self._path))

    def read(self) -> PedalState | None:
        """Return the present state; see `PedalDevice`."""
        with contextlib.suppress(BlockingIOError):
            while True:
                data = self._socket.recv(64)
                if len(data) == _DATAGRAM.size:
                    self._state = PedalState(*_DATAGRAM.unpack(data))
                    self._heard_at = self._clock()
        silence = self._clock() - self._heard_at
        if self._state is not None and silence > self._limit_ns:
            limit = f"{self._limit_ns * 1e-9:g} s"
            raise DeviceMissing(self.name, "fell silent", value=f"{silence * 1e-9:.3f} s", limit=limit)
        return self._state

    def close(self) -> None:
        """Remove the socket."""
        self._socket.close()
        self._path.unlink(missing_ok=True)


class PedalSender:
    """The device end of a LocalPedal; nothing happens while nobody listens.

    Attributes:
        tamper: takes a state and returns those that are sent: none, one or more; the seam for injected faults.
    """

    def __init__(self, name: str = "pedal") -> None:
        self.tamper: PedalTamper | None = None
        self._path = str(runtime_directory() / f"{name}.pedal")
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)

    def send(self, state: PedalState) -> bool:
        """Send the state; False when nobody takes it."""
        try:
            for sent in [state] if self.tamper is None else self.tamper(state):
                self._socket.sendto(_DATAGRAM.pack(*sent), self._path)
        except OSError:
            return False
        return True

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class InProcessPedal:
    """A pedal whose device end is a method call; for stepped tests and single-process runs.

    Args:
        age_limit: longest silence, s, once something was heard; as with `LocalPedal`.
        clock: time in ns; without one silence does not matter.

    Attributes:
        tamper: takes a state and returns those that arrive: none, one or more; the seam for injected faults.
    """

    def __init__(self, age_limit: float = AGE_LIMIT, clock: Callable[[], int] | None = None) -> None:
        self.tamper: PedalTamper | None = None
        self._clock, self._limit_ns, self._heard_at = clock, round(age_limit * 1e9), 0
        self._state: PedalState | None = None
        self._lost: str | None = None

    def put(self, state: PedalState | None) -> None:
        """Be the device: press it so, or (None) be lost."""
        self._lost = "was unplugged" if state is None else None
        if state is None or self.tamper is None:
            self._take(state)
            return
        for sent in self.tamper(state):
            self._take(sent)

    def _take(self, state: PedalState | None) -> None:
        self._state = state
        self._heard_at = self._clock() if self._clock is not None else 0

    def read(self) -> PedalState | None:
        """Return the present state; see `PedalDevice`."""
        if self._lost is not None:
            raise DeviceMissing("in-process pedal", self._lost, remedy="put a state")
        silence = 0 if self._clock is None or self._state is None else self._clock() - self._heard_at
        if silence > self._limit_ns:
            limit = f"{self._limit_ns * 1e-9:g} s"
            raise DeviceMissing("in-process pedal", "fell silent", value=f"{silence * 1e-9:.3f} s", limit=limit)
        return self._state

    def close(self) -> None:
        """Do nothing."""


def check_pedal(state: PedalState) -> bool:
    """Whether a state is one a pedal can have: a finite travel from 0 to 1."""
    return math.isfinite(state.travel) and 0.0 <= state.travel <= 1.0
