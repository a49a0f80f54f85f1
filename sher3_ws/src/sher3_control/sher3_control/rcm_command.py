"""The live command of the remote centre: `rcm here DEPTH`, `rcm X Y Z` (m, in {b}), `rcm off`."""

from __future__ import annotations

import math

from .errors import SettingsError
from .modes import Vector
from .motion import MotionController
from .ownership import Mode


def apply_rcm_command(motion: MotionController, text: str, q: Vector) -> None:
    """Set or leave the remote centre with the robot at `q` (5,).

    Raises:
        SettingsError: not understood, no joint positions, while the robot moves, or the shaft is not on the centre.
    """
    words = text.split()[1:]
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
        if not 0.0 <= numbers[0] <= 0.2:
            raise SettingsError(
                "depth of the remote centre [m]", value=numbers[0], limit=(0.0, 0.2), remedy="correct it"
            )
        modes.set_centre(modes.centre_behind_tip(numbers[0], q), q)
    elif len(numbers) == 3:
        modes.set_centre(tuple(numbers), q)
    else:
        remedy = "send `rcm here DEPTH`, `rcm X Y Z` in m, or `rcm off`"
        raise SettingsError("remote-centre command not understood", value=text, remedy=remedy)


def _numbers(words: list[str]) -> list[float]:
    try:
        return [float(word) for word in words]
    except ValueError:
        return []
