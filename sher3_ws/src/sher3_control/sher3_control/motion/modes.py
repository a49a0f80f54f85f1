"""What a motion mode is: it accepts commands, and at every tick it says what the robot should do."""

from __future__ import annotations

import math
from typing import Any, NamedTuple, Protocol

from sher3_common.reasons import Reason
from sher3_common.stamps import seconds
from sher3_common.vectors import Vector

from sher3_control.errors import CommandRejected


class Step(NamedTuple):
    """What a mode wants at one tick.

    Attributes:
        reason: MOVING, or why the mode ends here and the robot stops.
        setpoint: positions (5,) and velocities (5,) of a position mode, the references of the host law.
        joints: velocity (5,) of a velocity mode in actuator space.
        twist: tip twist (6,) in {b} of a velocity mode.
        finished: the mode has reached its goal and hands the robot back.
    """

    reason: Reason = Reason.MOVING
    setpoint: tuple[Vector, Vector] | None = None
    joints: Vector | None = None
    twist: Vector | None = None
    finished: bool = False


class MotionMode(Protocol):
    """A motion mode with its own memory.

    Attributes:
        name: CRTK name of its command.
        busy: it is under way to a goal.
    """

    name: str
    busy: bool

    def accept(self, command: Any, now: int, q: Vector) -> None:
        """Take a command at the time `now` [ns] with the robot at `q` (5,).

        Raises:
            CommandRejected: with the reason; the mode is unchanged.
        """

    def step(self, now: int, q: Vector) -> Step:
        """Return what to do at the tick `now` [ns] with the robot at `q` (5,)."""

    def reset(self) -> None:
        """Forget everything, because the mode has lost the robot."""


def require_finite(mode: str, values: Vector | None, count: int, what: str) -> Vector:
    """Return `values` if they are `count` finite numbers; `mode` and `what` name command and numbers in the error.

    Raises:
        CommandRejected: the values are absent, of another number, NaN or infinite.
    """
    if values is None or len(values) != count:
        found = 0 if values is None else len(values)
        raise CommandRejected(mode, f"needs {count} {what}", value=found, limit=count, remedy="fill the message")
    if not math.isfinite(sum(values)):
        raise CommandRejected(mode, f"{what} not finite", value=values, remedy="send finite numbers")
    return values


def require_timely(mode: str, stamp: int, now: int, age_limit: int, ahead_limit: int) -> None:
    """Refuse a command whose stamp is older, or further ahead of `now`, than its limit; all times in ns.

    Raises:
        CommandRejected: the command of `mode` is unstamped, stale or too early.
    """
    if stamp <= 0:
        raise CommandRejected(mode, "unstamped", value=stamp, remedy="stamp it with the system time")
    if now - stamp > age_limit:
        age, limit = seconds(now - stamp), seconds(age_limit)
        raise CommandRejected(mode, "stale [s]", value=age, limit=limit, remedy="send it in time")
    if stamp - now > ahead_limit:
        lead, limit = seconds(stamp - now), seconds(ahead_limit)
        raise CommandRejected(mode, "too early [s]", value=lead, limit=limit, remedy="send it later")
