"""A joystick or a SpaceMouse as the surgeon's hand and foot, read from its Linux device without a library.

`/dev/input/js*` is the joystick interface (`linux/joystick.h`): 8 bytes an event. `/dev/input/event*` is the input
interface (`linux/input.h`): 24 bytes an event; a SpaceMouse is there with six axes.
"""

from __future__ import annotations

import os
import struct
from pathlib import Path

from sher3_common.vectors import Wrench

from sher3_bringup.errors import ConfigurationError

FORCE, TORQUE = 2.0, 0.02
"""Push [N] and turn [N m] of a device at the end of its travel."""
DEAD = 0.06
"""Share of the travel around the middle that counts as none: sticks do not return exactly."""
_JOYSTICK = struct.Struct("<IhBB")
_INPUT = struct.Struct("<qqHHi")
_JS_BUTTON, _JS_AXIS, _JS_START = 0x01, 0x02, 0x80
_KEY, _RELATIVE, _ABSOLUTE = 0x01, 0x02, 0x03
TRAVEL = {"js": 32767.0, "event": 350.0}
"""Count at the end of an axis: of joysticks by the interface, of a SpaceMouse by its data sheet."""


class Device:
    """Axes and buttons of a device.

    Attributes:
        axes: six shares of the travel, -1 to 1: right, away, down, and the turns about them.
        pressed: whether any button is held; it is the pedal.
    """

    def __init__(self, path: Path | str) -> None:
        """Open a device.

        Raises:
            ConfigurationError: it is not there, or may not be read.
        """
        self.axes, self._buttons = [0.0] * 6, set[int]()
        self._kind = "js" if Path(path).name.startswith("js") else "event"
        try:
            self._file = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
        except OSError as error:
            remedy = "plug it in, and let your user read it (group `input`)"
            raise ConfigurationError(f"{path} cannot be read ({error.strerror})", remedy=remedy) from error

    @property
    def pressed(self) -> bool:
        """Whether any button is held."""
        return bool(self._buttons)

    def close(self) -> None:
        """Close the device."""
        os.close(self._file)

    def hands(self, _: float) -> tuple[float, Wrench]:
        """Return pedal travel and wrench; a device that has gone has let go of both."""
        self._read()
        right, away, down, *turns = (value if abs(value) > DEAD else 0.0 for value in self.axes)
        x, y, z = (FORCE * value for value in (-away, -right, -down))
        rx, ry, rz = (TORQUE * value for value in (-turns[1], -turns[0], -turns[2]))
        return float(self.pressed), (x, y, z, rx, ry, rz)

    def _read(self) -> None:
        event = _JOYSTICK if self._kind == "js" else _INPUT
        try:
            while len(data := os.read(self._file, event.size)) == event.size:
                self.take(*(self._of_joystick(data) if self._kind == "js" else self._of_input(data)))
        except BlockingIOError:
            return
        except OSError:
            self.axes, self._buttons = [0.0] * 6, set()

    def take(self, what: str, number: int, value: float) -> None:
        """Take one event: `axis` with its share of the travel, `button` with 1 or 0; others do nothing."""
        if what == "axis" and number < len(self.axes):
            self.axes[number] = min(1.0, max(-1.0, value))
        elif what == "button":
            (self._buttons.add if value else self._buttons.discard)(number)

    def _of_joystick(self, data: bytes) -> tuple[str, int, float]:
        _, value, kind, number = _JOYSTICK.unpack(data)
        what = {_JS_AXIS: "axis", _JS_BUTTON: "button"}.get(kind & ~_JS_START, "")
        return what, number, value / TRAVEL["js"] if what == "axis" else value

    def _of_input(self, data: bytes) -> tuple[str, int, float]:
        _, _, kind, code, value = _INPUT.unpack(data)
        if kind in (_RELATIVE, _ABSOLUTE):
            return "axis", code, value / TRAVEL["event"]
        return ("button", code, value) if kind == _KEY else ("", 0, 0.0)
