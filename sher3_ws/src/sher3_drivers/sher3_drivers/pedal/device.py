"""The foot pedal as its node sees it: a travel from 0 to 1 and an emergency stop.

A pedal that is missing or lost is an error. It is never taken for a released pedal, and its last state is not
repeated for ever: both would go unnoticed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, Protocol

AGE_LIMIT = 0.02
"""Longest silence of a pedal that says its whole state again and again, s. At the tip's 5 mm/s that is 100 um."""

TOUCHED = 0.02
"""Travel at which the contacts switch, as a share; below it nothing moves, whatever they say."""


class PedalState(NamedTuple):
    """What a pedal says.

    Attributes:
        travel: how far it is pressed, from 0 (released) to 1.
        emergency_stop: whether the emergency stop is pressed.
        made: whether the contact that closes when the pedal is pressed is closed; None where that is not known.
        rest: the same of the contact that is closed while the pedal is at rest.
    """

    travel: float
    emergency_stop: bool
    made: bool | None = None
    rest: bool | None = None


def wired(state: PedalState) -> PedalState:
    """Return the state of a mock pedal with its two contacts, where it does not name them."""
    if state.made is not None:
        return state
    pressed = not state.travel <= TOUCHED
    return PedalState(state.travel, state.emergency_stop, pressed, not pressed)


PedalTamper = Callable[[PedalState], list[PedalState]]
"""Takes a state and returns those that are sent: none, one or more. The seam for injected faults."""


class PedalDevice(Protocol):
    """A pedal back-end."""

    def read(self) -> PedalState | None:
        """Return the present state, None when the pedal has not said anything yet.

        Raises:
            DeviceMissing: the pedal is gone or has been silent for too long.
        """

    def close(self) -> None:
        """Let the device go."""


def check_pedal(state: PedalState) -> bool:
    """Return whether a pedal can have this state: a finite travel from 0 to 1."""
    return math.isfinite(state.travel) and 0.0 <= state.travel <= 1.0
