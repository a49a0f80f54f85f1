"""The surgeon at the keyboard: keys change hand and foot; plain data, no terminal."""

from __future__ import annotations

from sher3_common.operating_state import StateCommand
from sher3_common.vectors import Wrench

HELP = """Keys: w/s x, a/d y, r/f z push harder (N) · i/k, j/l, u/o turn harder (N*m) · space drops the tool
      p pedal pressed or released · e enable · x disable · q quit"""
FORCE_STEP = 0.2
TORQUE_STEP = 0.005
FORCE_LIMIT = 5.0
TORQUE_LIMIT = 0.05
_AXES = "wsadrfikjluo"
_COMMANDS = {"e": StateCommand.ENABLE.value, "x": StateCommand.DISABLE.value}


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
        self._pending = ""
        self._shown = ""

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
        else:
            self._pending = _COMMANDS.get(key, self._pending)

    def hands(self, _: float) -> tuple[float, Wrench]:
        """Return pedal travel and wrench."""
        return float(self.pressed), tuple(self.wrench)  # type: ignore[return-value]

    def command(self, _: float) -> str:
        """Return the state command that was asked for, once."""
        command, self._pending = self._pending, ""
        return command

    def line(self) -> str:
        """Return the status line."""
        fx, fy, fz, mx, my, mz = self.wrench
        pedal = "pressed " if self.pressed else "released"
        return f"pedal {pedal}  force {fx:+.1f} {fy:+.1f} {fz:+.1f} N  torque {mx:+.3f} {my:+.3f} {mz:+.3f} N*m"

    def changed(self) -> bool:
        """Tell whether the status line differs from the one shown last."""
        before, self._shown = self._shown, self.line()
        return self._shown != before
