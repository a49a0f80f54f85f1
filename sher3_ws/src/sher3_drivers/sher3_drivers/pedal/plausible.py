"""Can a foot do this? Two contacts that contradict each other, presses too many or too long; pure, with time given.

A pedal has two antivalent contacts beside its travel: one is made when it is pressed, the other when it is at rest
(two channels as in EN ISO 13849-1, category 3). The robot moves on a travel only while both say that it is pressed.
"""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

from sher3_drivers.pedal.device import TOUCHED, PedalState

LOST = PedalState(math.nan, True)
"""State of a pedal that is not there: whoever hears it stops as at the emergency stop."""
_UNUSABLE = math.nan
"""Travel of a pedal that must be released before it counts again: whoever hears it stops the motion."""


class PedalLimits(NamedTuple):
    """What a foot does.

    Attributes:
        switching: longest time for which the contacts may agree, or contradict the travel, s: a slow foot on its way.
        presses: largest number of presses within `within`. A foot taps up to 5 times a second.
        within: s.
        longest: longest press, s: a surgeon's motion takes seconds, a foot that fell asleep does not end.
        rest: time at rest after which a pedal with too many presses counts again, s.
    """

    switching: float = 0.05
    presses: int = 8
    within: float = 1.0
    longest: float = 120.0
    rest: float = 0.5


FOOT = PedalLimits()
"""What is taken for a foot."""


class PedalWatch:
    """Judges the states of one pedal, in the order of time.

    Attributes:
        fault: why the pedal is not believed now, None while it is.
    """

    def __init__(self, limits: PedalLimits = FOOT) -> None:
        self._switching, self._within, self._longest, self._rest = (
            round(seconds * 1e9) for seconds in (limits.switching, limits.within, limits.longest, limits.rest)
        )
        self._limits = limits
        self._doubtful_since: int | None = None
        self._pressed_since: int | None = None
        self._at_rest_since: int | None = None
        self._presses: deque[int] = deque(maxlen=limits.presses + 1)
        self._barred = ""
        self.fault: str | None = None

    def judge(self, state: PedalState, now: int) -> PedalState:
        """Return the state [time `now` ns] as the robot may use it: itself, released, unusable, or lost."""
        pressed, at_rest = bool(state.made and not state.rest), bool(state.rest and not state.made)
        agree = (pressed and state.travel > 0.0) or (at_rest and state.travel <= TOUCHED)
        self._doubtful_since = None if agree else self._doubtful_since or now
        if self._doubtful_since is not None and now - self._doubtful_since > self._switching:
            made, rest = state.made, state.rest
            self.fault = f"contacts made {made}, at rest {rest} contradict each other or the travel {state.travel:.2f}"
            return LOST
        self._count(pressed, at_rest, now)
        self.fault = self._barred or None
        if self._barred:
            return PedalState(_UNUSABLE, state.emergency_stop)
        return state if pressed else state._replace(travel=0.0)

    def _count(self, pressed: bool, at_rest: bool, now: int) -> None:
        """Count presses and their time; bar a pedal that does what no foot does, until it has been at rest."""
        if pressed and self._pressed_since is None:
            self._pressed_since = now
            self._presses.append(now)
        elif not pressed:
            self._pressed_since = None
        self._at_rest_since = (self._at_rest_since or now) if at_rest else None
        if len(self._presses) > self._limits.presses and now - self._presses[0] < self._within:
            self._barred = f"pressed more than {self._limits.presses} times in {self._limits.within:g} s"
        elif self._pressed_since is not None and now - self._pressed_since > self._longest:
            self._barred = f"pressed for more than {self._limits.longest:g} s"
        elif self._at_rest_since is not None and now - self._at_rest_since >= self._rest:
            self._barred = ""
