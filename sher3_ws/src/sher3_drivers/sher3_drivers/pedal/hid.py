"""A pedal that tells its whole state again and again, on Linux' raw HID interface (/dev/hidraw*).

The joystick interface tells changes only, so that a dead pedal looks like one that is held. Here every report holds the
state and a counter: a pedal whose reports stay away, or whose counter stands, has fallen silent.
"""

from __future__ import annotations

import os
import struct
import time
from collections.abc import Callable

from sher3_drivers.errors import DeviceMissing
from sher3_drivers.pedal.device import AGE_LIMIT, PedalState

REPORT = struct.Struct("<HBB")
"""Travel (0 released, 65535 pressed), switches, counter: the report of the pedal's own controller, 100 Hz or more."""
MADE, REST, STOP = 1, 2, 4
"""Switches: the contact that closes when the pedal is pressed, the one that opens, the emergency stop."""
_FULL = 65535


class HidPedal:
    """A pedal on a raw HID device.

    Args:
        path: device, as in /dev/hidraw0.
        age_limit: longest time without a new report, s, once one has come.
        clock: time in ns.
    """

    def __init__(
        self,
        path: str = "/dev/hidraw0",
        age_limit: float = AGE_LIMIT,
        clock: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self.name = f"pedal {path}"
        self._limit_ns, self._clock, self._heard_at = round(age_limit * 1e9), clock, 0
        self._state: PedalState | None = None
        self._counter: int | None = None
        try:
            self._fd = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        except OSError as error:
            remedy = "plug it in and check the permissions, name another device, or run with --mock"
            raise DeviceMissing(self.name, error.strerror or str(error), remedy=remedy) from error

    def read(self) -> PedalState | None:
        """Return the present state; see `PedalDevice`."""
        try:
            while True:
                data = os.read(self._fd, REPORT.size)
                if not data:
                    raise DeviceMissing(self.name, "was unplugged", remedy="plug it in and restart")
                if len(data) == REPORT.size:
                    self._take(*REPORT.unpack(data))
        except BlockingIOError:
            pass
        except OSError as error:
            raise DeviceMissing(self.name, f"was lost: {error.strerror}", remedy="plug it in and restart") from error
        silence = self._clock() - self._heard_at
        if self._state is not None and silence > self._limit_ns:
            limit = f"{self._limit_ns * 1e-9:g} s"
            raise DeviceMissing(self.name, "fell silent", value=f"{silence * 1e-9:.3f} s", limit=limit)
        return self._state

    def _take(self, travel: int, switches: int, counter: int) -> None:
        if counter == self._counter:
            return
        self._counter, self._heard_at = counter, self._clock()
        made, rest, stop = (bool(switches & bit) for bit in (MADE, REST, STOP))
        self._state = PedalState(travel / _FULL, stop, made, rest)

    def close(self) -> None:
        """Close the device; closing twice is allowed."""
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1
