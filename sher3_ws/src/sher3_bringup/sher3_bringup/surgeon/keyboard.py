"""The surgeon at the keyboard: keys change hand and foot and ask the robot for things; plain data, no terminal."""

from __future__ import annotations

from typing import NamedTuple

from sher3_common.operating_state import StateCommand
from sher3_common.vectors import Wrench

HELP = """Hand    w/s x, a/d y, r/f z push harder (N) · i/k, j/l, u/o turn harder (N*m) · space drops the tool
Foot    p pedal pressed or released
Robot   e enable · x disable · z pause · c continue · t tare · g near tissue, G free · h remote centre, H none
        q quit
A force stays until you change it: with the pedal pressed the tip goes on under it. Space, then p, and it rests."""
FORCE_STEP = 0.2
TORQUE_STEP = 0.005
FORCE_LIMIT = 5.0
TORQUE_LIMIT = 0.05
RCM_DEPTH = 0.018
"""Where `h` puts the remote centre [m] behind the tip: a little more than an eye's wall is from its retina's middle."""
TARE = "admittance/tare"
"""Service of the tare; the other requests are topics."""
_AXES = "wsadrfikjluo"


class Asked(NamedTuple):
    """What a key asks of the robot: the topic (or `TARE`) and the text for it."""

    topic: str
    text: str = ""


KEYS = {
    "e": Asked("command/state_command", StateCommand.ENABLE.value),
    "x": Asked("command/state_command", StateCommand.DISABLE.value),
    "z": Asked("command/state_command", StateCommand.PAUSE.value),
    "c": Asked("command/state_command", StateCommand.RESUME.value),
    "g": Asked("command/regime", "near_tissue"),
    "G": Asked("command/regime", "free"),
    "h": Asked("command/rcm", f"here {RCM_DEPTH}"),
    "H": Asked("command/rcm", "off"),
    "t": Asked(TARE),
}


class Keyboard:
    """State of hand and foot.

    Attributes:
        wrench: on the tip in {b}: N, N*m.
        pressed: whether the pedal is pressed.
        quit: whether `q` was pressed.
    """

    def __init__(self) -> None:
        self.wrench = [0.0] * 6
        self.pressed = False
        self.quit = False
        self._asked: list[Asked] = []

    def press(self, key: str) -> None:
        """Take one key; unknown ones do nothing."""
        if key and key in _AXES:
            axis, minus = divmod(_AXES.index(key), 2)
            step, limit = (FORCE_STEP, FORCE_LIMIT) if axis < 3 else (TORQUE_STEP, TORQUE_LIMIT)
            value = self.wrench[axis] + (-step if minus else step)
            self.wrench[axis] = min(max(value, -limit), limit)
        elif key == " ":
            self.wrench = [0.0] * 6
        elif key == "p":
            self.pressed = not self.pressed
        elif key == "q":
            self.quit = True
        elif key in KEYS:
            self._asked.append(KEYS[key])

    def hands(self, _: float) -> tuple[float, Wrench]:
        """Return pedal travel and wrench."""
        return float(self.pressed), tuple(self.wrench)  # type: ignore[return-value]

    def asked(self) -> list[Asked]:
        """Return what was asked for since the last call."""
        asked, self._asked = self._asked, []
        return asked

    def line(self) -> str:
        """Return what hand and foot do."""
        fx, fy, fz, mx, my, mz = self.wrench
        pedal = "pressed " if self.pressed else "released"
        return f"pedal {pedal}  force {fx:+.1f} {fy:+.1f} {fz:+.1f} N  torque {mx:+.3f} {my:+.3f} {mz:+.3f} N*m"
