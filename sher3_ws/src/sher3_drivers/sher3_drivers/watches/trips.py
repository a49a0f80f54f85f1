"""What a watch of the motor driver says when it objects, and the log of the stop that came of it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

from sher3_common.reasons import ACTION, Action, Reason


class Trip(NamedTuple):
    """An objection.

    Attributes:
        reason: code, which decides the action.
        text: a sentence that names the component and the numbers.
        value, limit: what was measured and its limit, in `unit`.
        unit: unit of both.
        axes: numbers of the axes whose drives do not do what they are told; none where no drive is suspected.
    """

    reason: Reason
    text: str
    value: float = 1.0
    limit: float = 0.0
    unit: str = "1"
    axes: tuple[int, ...] = ()

    @property
    def action(self) -> Action:
        """How hard the robot is stopped for it."""
        return ACTION[self.reason]


def together(trips: Iterable[Trip | None]) -> Trip | None:
    """Return the first of some objections of one tick, with the axes of all of them; None where nobody objects."""
    said = [trip for trip in trips if trip is not None]
    if len(said) < 2:  # nearly always
        return said[0] if said else None
    return said[0]._replace(axes=tuple(sorted({axis for trip in said for axis in trip.axes})))


@dataclass
class StopLog:
    """Why the driver stopped: the first trip is kept, later ones are counted, the most severe action wins.

    Attributes:
        first: the trip that stopped the robot, None while nothing has.
        since: when, ns.
        later: number of trips that followed.
        action: the most severe action of all of them.
    """

    first: Trip | None = None
    since: int = 0
    later: int = 0
    action: Action = Action.NONE

    @property
    def reason(self) -> str | None:
        """The sentence of the first trip."""
        return None if self.first is None else self.first.text

    @property
    def code(self) -> Reason:
        """The code of the first trip, MOVING without one."""
        return Reason.MOVING if self.first is None else self.first.reason

    def add(self, trip: Trip, now: int, action: Action | None = None) -> bool:
        """Note a trip at time `now` (ns), with its action or one given instead; return True when it is the first."""
        self.action = max(self.action, trip.action if action is None else action)
        if self.first is None:
            self.first, self.since = trip, now
            return True
        self.later += 1
        return False

    def clear(self) -> None:
        """Forget everything."""
        self.first, self.since, self.later, self.action = None, 0, 0, Action.NONE
