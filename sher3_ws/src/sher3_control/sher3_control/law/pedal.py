"""The foot pedal as a velocity factor from 0 to 1, with dead band and hysteresis."""

import math
from collections.abc import Sequence

from sher3_common.compiled import compiled


def pedal_reading(axes: Sequence[float], buttons: Sequence[int]) -> tuple[float, bool]:
    """Return travel and emergency stop of a sample of `pedal/measured`: one axis and one button.

    A message of another form, as that of a gamepad, is no pedal: its travel is NaN, so that the robot does not move,
    and none of its buttons is an emergency stop.
    """
    if len(axes) != 1 or len(buttons) != 1:
        return math.nan, False
    return float(axes[0]), bool(buttons[0])


@compiled
def pedal_pressed(travel: float, was_pressed: bool, press: float, release: float) -> bool:
    """Return whether the pedal counts as pressed.

    It is pressed from the travel `press` on and released at `release` and below [1]; in between it keeps its former
    state.
    """
    if was_pressed:
        return travel > release
    return travel >= press


@compiled
def pedal_factor(travel: float, pressed: bool, release: float, binary: bool) -> float:
    """Return the velocity factor: 0 when released, else 1 (binary) or the share of the travel beyond `release`.

    The proportional factor rises with the travel, from 0 at `release` to 1 at full travel.
    """
    if not pressed:
        return 0.0
    if binary:
        return 1.0
    return (travel - release) / (1.0 - release)
