"""The text on `command/rcm`: `here DEPTH` (m behind the tip on the shaft), `X Y Z` (m, in {b}) or `off`."""

from __future__ import annotations

import math

from sher3_common.vectors import Vector

from sher3_control.errors import SettingsError
from sher3_control.motion.controller import MotionController
from sher3_control.motion.ownership import Mode

DEEPEST = 0.2
"""Farthest a remote centre may lie behind the tip [m]: a depth sent in mm is refused."""


def apply_rcm_command(motion: MotionController, text: str, q: Vector) -> None:
    """Set the remote centre, or leave it, with the robot at `q` (5,), empty without a sample.

    Raises:
        SettingsError: the text is not understood, there are no joint positions, the pedal is pressed, or the shaft does
            not pass through the centre.
    """
    words = text.split()
    if motion.ownership.owner is Mode.COOPERATIVE:
        raise SettingsError("the remote centre cannot change while the pedal is pressed", remedy="release the pedal")
    modes = motion.velocity_modes
    if words == ["off"]:
        modes.set_centre(None, q)
        return
    if len(q) != 5 or not math.isfinite(sum(q)):
        raise SettingsError("no joint positions yet", remedy="check the drives")
    numbers = _numbers(words[1:] if words[:1] == ["here"] else words)
    if words[:1] == ["here"] and len(numbers) == 1:
        if not 0.0 <= numbers[0] <= DEEPEST:
            raise SettingsError(
                "depth of the remote centre [m]", value=numbers[0], limit=(0.0, DEEPEST), remedy="correct it"
            )
        modes.set_centre(modes.centre_behind_tip(numbers[0], q), q)
    elif len(numbers) == 3:
        modes.set_centre(tuple(numbers), q)
    else:
        remedy = "send `here DEPTH`, `X Y Z` in m, or `off`"
        raise SettingsError("remote-centre command not understood", value=text, remedy=remedy)


def _numbers(words: list[str]) -> list[float]:
    try:
        return [float(word) for word in words]
    except ValueError:
        return []
