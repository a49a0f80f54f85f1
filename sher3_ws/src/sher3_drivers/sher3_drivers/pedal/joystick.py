"""A pedal on the Linux joystick interface (include/uapi/linux/joystick.h)."""

from __future__ import annotations

import os
import struct

from sher3_drivers.errors import DeviceMissing
from sher3_drivers.pedal.device import PedalState

JS_EVENT = struct.Struct("<IhBB")
"""struct js_event: time [ms], value, type, number."""

_BUTTON, _AXIS, _INIT = 0x01, 0x02, 0x80
"""Types of an event; the last is a flag on those that tell the state at opening."""
_FULL = 32767
"""Largest value of an axis; the smallest is its negative."""


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
