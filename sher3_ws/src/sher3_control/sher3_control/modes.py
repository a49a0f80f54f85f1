"""What a motion mode is: it accepts commands, and once a tick it says what the robot should do."""

from __future__ import annotations

import math
from typing import Any, NamedTuple, Protocol, TypeAlias

from .errors import CommandRejected
from .reasons import Reason

Vector: TypeAlias = tuple[float, ...]


class Step(NamedTuple):
    """What a mode wants at one tick.

    Attributes:
        reason: MOVING, or why the mode ends here; then the robot stops.
        setpoint: reference position and velocity (5,), (5,) of a position mode, to go through the host law.
        joints: velocity (5,) of a velocity mode in actuator space.
        twist: tip twist (6,) of a velocity mode in {b}.
        finished: the mode is done and hands the robot back.
    """

    reason: Reason = Reason.MOVING
    setpoint: tuple[Vector, Vector] | None = None
    joints: Vector | None = None
    twist: Vector | None = None
    finished: bool = False


class MotionMode(Protocol):
    """A motion mode with its own memory; `accept` must leave it unchanged when it raises."""

    name: str
    busy: bool

    def accept(self, command: Any, now: int, q: Vector) -> None:
        """Take a command at time `now` [ns] with the robot at `q` (5,).

        Raises:
            CommandRejected: with the reason.
        """

    def step(self, now: int, q: Vector) -> Step:
        """Return what to do at tick `now` [ns] with the robot at `q`."""

    def reset(self) -> None:
        """Forget everything: the mode lost the robot."""


def require_finite(mode: str, values: Vector | None, count: int, what: str) -> Vector:
    """Return `values` if there are `count` finite ones.

    Raises:
        CommandRejected: absent, wrong length, NaN or infinite.
    """
    if values is None or len(values) != count:
        found = 0 if values is None else len(values)
        raise CommandRejected(mode, f"needs {count} {what}", value=found, limit=count, remedy="fill the message")
    if not math.isfinite(sum(values)):
        raise CommandRejected(mode, f"{what} not finite", value=values, remedy="send finite numbers")
    return values


def require_timely(mode: str, stamp: int, now: int, age_limit: int, ahead_limit: int) -> None:
    """Refuse a command that is older or further ahead than the limits [ns].

    Raises:
        CommandRejected: unstamped, stale or too early.
    """
    if stamp <= 0:
        raise CommandRejected(mode, "unstamped", value=stamp, remedy="stamp it with the system time")
    if now - stamp > age_limit:
        age = (now - stamp) * 1e-9
        raise CommandRejected(mode, "stale [s]", value=age, limit=age_limit * 1e-9, remedy="send it in time")
    if stamp - now > ahead_limit:
        lead = (stamp - now) * 1e-9
        raise CommandRejected(mode, "too early [s]", value=lead, limit=ahead_limit * 1e-9, remedy="send it later")
