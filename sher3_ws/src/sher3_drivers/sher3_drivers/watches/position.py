"""Has an axis left the place that its commands add up to? Nothing is forgotten from one enabling to the next stop.

The judge is what was sent: the velocity commands on the wire, each held from one SYNC to the next, summed up. Both
encoders have to say that the axis is elsewhere; when they differ, that is the business of `watches.joints`. The tip
adds up what all axes are off, so they are judged together: the squares of their shares of their limits may come to one.
Of the rest that the drive says only its force counts, since that is what holds the hand. A PI velocity loop
(recorded-run contract, section 3) exerts u = kp (c - v) + ki e, where e is the sum of (c - v): it has no steady error
but the load over ki. Its law solved for e is a low pass of the force, e + (kp / ki) de/dt = u / ki. What is left of e
beyond that is a departure.

A stop goes on with the sums: what a drive is told then is its ramp. It may brake sooner, as by itself, so an axis may
be anywhere from where the stop found it to the end of its ramp, and nowhere else, with its force or without power.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from sher3_common.compiled import compiled, direct
from sher3_common.reasons import Reason, reading
from sher3_common.vectors import Vector

from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.row import Row
from sher3_drivers.watches.trips import Trip

_LIMITS = ("plain", "elastic", "sudden", "lag", "share", "time", "keep", "hold")
_SUMS = ("path", "base", "force", "left", "by_motor", "by_load", "explained", "away")
_MEMORY = ("motor", "load", "peak", "yields", "limit", "brakes", *_SUMS)
_CARRIED = 0.75
"""Share of the plain limits up to which departures, each and all together, are carried over into a stop. Healthy axes
come to 0.51 of them together and keep a quarter for the stop; at half an axis that goes by itself beside a leg that is
cut off moved the tip by 41.5 um near tissue, where 40 are allowed."""
PLACE = np.dtype([(name, np.float64) for name in (*_LIMITS, *_MEMORY)])
"""A row: the limits of an axis and what is remembered of it, in m or rad. `left` is how far it is from the sum of its
commands since the beginning, by the encoder that says less; `explained` how much of that its force explains, at most
`yields`, which is `elastic`, and `sudden` from a stop on; `away` is the departure, `limit` the largest one at the
newest speeds and force. `brakes` is 1 from a stop on: then `path` is the travel of the ramp since, of which the axis
may do without any part."""


def begin_places(places: Any, motor: Vector, load: Vector, effort: Vector) -> None:
    """Take these readings (n,) as the beginning, in place; the force `effort` [N, N m] is what holds an axis there."""
    for name in _MEMORY:
        places[name] = 0.0
    places["motor"], places["load"] = motor, load
    places["base"] = places["force"] = np.divide(effort, places["hold"])
    places["limit"], places["yields"] = places["plain"], places["elastic"]


def brake_places(places: Any, rests: bool) -> None:
    """Begin a stop, or a rest, in place, where the axes are.

    What force explained is of the past, a departure is carried over. A drive that goes on by itself may report a force
    too, so from now on it explains no more than what a moving axis may be pushed off. What speed adds to the limit
    stays for the whole braking, since a ramp that was late ends further away, and is gone in a rest.
    """
    bound = _CARRIED * places["plain"]
    carried = np.clip(places["away"], -bound, bound)
    carried *= _CARRIED / max(_CARRIED, np.linalg.norm(carried / places["plain"]))
    places["motor"] += places["path"] - places["by_motor"] + carried
    places["load"] += places["path"] - places["by_load"] + carried
    for name in ("by_motor", "by_load", "left", "away"):
        places[name] = carried
    places["base"] = places["force"]
    places["path"] = places["explained"] = 0.0
    places["peak"] *= not rests
    places["brakes"], places["yields"] = 1.0, places["sudden"]


@compiled(error_model="numpy")
def follow_places(places: Any, motor: Vector, load: Vector, effort: Vector, command: Vector, since: float) -> bool:
    """Add the commands (n,) [m/s, rad/s] that held for `since` s, in place, and take the readings (n,) after them.

    Returns:
        Whether the axes together are further from where commands and force put them than their limits.
    """
    squares = 0.0
    for number in range(len(places)):
        place = places[number]
        _advance(place, motor[number], load[number], effort[number], command[number], since)
        squares += (place["away"] / place["limit"]) ** 2
    return squares > 1.0


@compiled(error_model="numpy")
def _advance(place: Any, motor: float, load: float, effort: float, command: float, since: float) -> None:
    place["path"] += command * since
    by_motor, by_load = place["path"] + place["motor"] - motor, place["path"] + place["load"] - load
    place["by_motor"], place["by_load"] = by_motor, by_load
    place["left"] = left = _lesser(by_load, by_motor)
    place["force"] += min(1.0, since / place["time"]) * (effort / place["hold"] - place["force"])
    place["explained"] = max(-place["yields"], min(place["yields"], place["force"] - place["base"]))
    place["away"] = left - place["explained"]
    if place["brakes"]:
        place["away"] = _lesser(_beyond(place["away"], place["path"]), _beyond(left, place["path"]))
    place["peak"] = max(abs(command), max(place["keep"], place["brakes"]) * place["peak"])
    place["limit"] = place["plain"] + place["lag"] * place["peak"] + place["share"] * abs(place["explained"])


@compiled(error_model="numpy")
def _lesser(one: float, other: float) -> float:
    return one if abs(one) < abs(other) else other


@compiled(error_model="numpy")
def _beyond(value: float, end: float) -> float:
    """Return how far a value is outside the range from 0 to `end`, which may be negative."""
    return value - max(min(0.0, end), min(max(0.0, end), value))


@cache
def _follow(count: int) -> Callable[..., bool]:
    """Return the compiled sums of so many axes; not kept in the watch, which can be copied."""
    zeros = (0.0,) * count
    return direct(follow_places, np.ones(count, PLACE), zeros, zeros, zeros, zeros, 0.0)


class AxisPosition(Row):
    """The sum of one axis in words.

    Args:
        scale: of the axis.
        settings: its limits.
        places: rows of all axes.
        number: of its row.
    """

    __slots__ = ()

    def __init__(self, scale: AxisScale, settings: MotorDriverSettings, places: Any, number: int) -> None:
        limits = {
            "plain": settings.position_angle if scale.revolute else settings.position_distance,
            "elastic": settings.elastic_angle if scale.revolute else settings.elastic_distance,
            "sudden": settings.following_angle if scale.revolute else settings.following_distance,
            "lag": settings.position_lag,
            "share": settings.position_force,
            "time": scale.settling,
            "keep": 1.0 - min(1.0, settings.period / settings.following_memory),
            "hold": scale.hold,
        }
        super().__init__(scale, places, number, limits)

    @property
    def departure(self) -> float:
        """How far the axis is from where commands and force put it, m or rad."""
        return self["away"]

    @property
    def limit(self) -> float:
        """Largest departure at the newest speeds and force, m or rad."""
        return self["limit"]

    @property
    def moved(self) -> float:
        """The same of an axis at rest, by its motor: a load encoder that comes back to life has moved nothing.

        Its drive may hold it or not, as without power, so the force counts only where it explains something.
        """
        by_motor = self["by_motor"]
        return min(by_motor, by_motor - self["explained"], key=abs)

    def reading(self) -> tuple[str, str]:
        """Return what is looked at now, with its limit, for the diagnostics."""
        return reading(Reason.POSITION_LEFT, self._name, abs(self.departure), self.limit, self._unit)


class PositionWatch:
    """The sums of the five axes.

    Attributes:
        axes: one per actuator, in the order of ACTUATORS.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self._scales = tuple(scales)
        self._rows = np.zeros(len(scales), PLACE)
        self.axes = [AxisPosition(scale, settings, self._rows, number) for number, scale in enumerate(scales)]
        zeros = (0.0,) * len(scales)
        begin_places(self._rows, zeros, zeros, zeros)
        self._begun = self._departed = False
        _follow(len(scales))

    def begin(self) -> None:
        """Begin at the next feedback."""
        self._begun = False

    def brake(self, rests: bool = False) -> None:
        """Go on with axes that stop, or that rest, from where the newest feedback has them."""
        if self._begun:
            brake_places(self._rows, rests)

    def follow(self, feedback: DriveFeedback, held: Vector, since: float) -> None:
        """Take a feedback and the commands (5,) [m/s, rad/s] held over the `since` s before it."""
        motor, load, effort = feedback.motor_position, feedback.load_position, feedback.effort
        if self._begun:
            self._departed = _follow(len(self.axes))(self._rows, motor, load, effort, held, since)
        else:
            begin_places(self._rows, motor, load, effort)
            self._begun, self._departed = True, False

    def judge(self, reason: Reason = Reason.POSITION_LEFT) -> Trip | None:
        """Object to the axis that is furthest from where its commands put it; whoever is half as far is suspected."""
        if not self._departed:
            return None
        shares = [abs(axis.departure) / axis.limit for axis in self.axes]
        worst = shares.index(max(shares))
        value, limit, scale = abs(self.axes[worst].departure), self.axes[worst].limit, self._scales[worst]
        text = (
            f"{scale.name}: {value:.3g} {scale.unit} from where its commands add up to (limit {limit:.3g}; "
            f"with all axes {math.hypot(*shares):.3g} of 1)"
        )
        suspects = tuple([n for n, share in enumerate(shares) if share > 0.5 * min(1.0, shares[worst])])
        return Trip(reason, text, value, limit, scale.unit, suspects)

    @property
    def moved(self) -> Vector:
        """How far the axes are from where they were at the beginning, commands and force aside (5,) [m, rad]."""
        return tuple([axis.moved for axis in self.axes])
