"""The servo modes: a stream of commands, each for the tick of its stamp. The robot stops when the stream ends."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Generic, TypeVar

from sher3_common.reasons import Reason
from sher3_common.stamps import nanoseconds
from sher3_common.vectors import Vector
from sher3_description import Robot

from sher3_control.errors import CommandRejected
from sher3_control.motion.commands import JointCommand, PoseCommand, TwistCommand
from sher3_control.motion.modes import Step, require_finite, require_timely
from sher3_control.settings import MotionSettings

C = TypeVar("C")
NO_VELOCITY: Vector = (0.0,) * 5
Inverse = Callable[[PoseCommand], Vector]
"""Returns the actuator positions (5,) of a tip pose; raises a Sher3Error that names the limit."""


class Stream(Generic[C]):
    """Commands by stamp.

    At a tick the newest command whose stamp has come is in force, until it is `timeout` old.

    Args:
        timeout: [ns].
        capacity: number of commands that may wait for their tick.

    Attributes:
        timeout: see above.
        stamp: of the command in force [ns], -1 without one.
        current: the command in force, None without one.
    """

    def __init__(self, timeout: int, capacity: int = 2000) -> None:
        self._waiting: deque[tuple[int, C]] = deque(maxlen=capacity)
        self.timeout = timeout
        self.stamp = -1
        self.current: C | None = None

    @property
    def last_stamp(self) -> int:
        """Stamp of the newest command received [ns], -1 without one."""
        return self._waiting[-1][0] if self._waiting else self.stamp

    @property
    def newest(self) -> C | None:
        """The newest command received."""
        return self._waiting[-1][1] if self._waiting else self.current

    def push(self, stamp: int, command: C) -> None:
        """Queue a command; call `refuse_disorder` first."""
        self._waiting.append((stamp, command))

    def refuse_disorder(self, mode: str, stamp: int) -> None:
        """Raise CommandRejected when `stamp` [ns] is not later than the newest one, or the queue is full."""
        if stamp <= self.last_stamp:
            remedy = "let the stamps rise"
            raise CommandRejected(mode, "out of order", value=stamp, limit=self.last_stamp, remedy=remedy)
        if len(self._waiting) == self._waiting.maxlen:
            raise CommandRejected(mode, "queue full", value=len(self._waiting), limit=self._waiting.maxlen)

    def at(self, now: int) -> tuple[Reason, C | None, bool]:
        """Return what is in force at the tick `now` [ns].

        Returns:
            MOVING, or why the stream has ended; the command in force, None without one; and whether it is for this very
            tick.
        """
        while self._waiting and self._waiting[0][0] <= now:
            self.stamp, self.current = self._waiting.popleft()
        if self.current is None:
            return (Reason.MOVING if self._waiting else Reason.COMMAND_MISSING), None, False
        if now - self.stamp > self.timeout:
            return Reason.COMMAND_STALE, None, False
        return Reason.MOVING, self.current, self.stamp == now

    def clear(self) -> None:
        """Forget all commands."""
        self._waiting.clear()
        self.stamp, self.current = -1, None


class _Servo(Generic[C]):
    """What all servo modes share: a stream of commands.

    Attributes:
        name: CRTK name of the command.
        busy: never, since a stream has no goal.
    """

    busy = False

    def __init__(self, name: str, settings: MotionSettings) -> None:
        self.name = name
        self._ahead = nanoseconds(settings.ahead_limit)
        self._stream: Stream[C] = Stream(nanoseconds(settings.servo_timeout))

    def _check_stamp(self, stamp: int, now: int) -> None:
        require_timely(self.name, stamp, now, self._stream.timeout, self._ahead)
        self._stream.refuse_disorder(self.name, stamp)

    def reset(self) -> None:
        """Forget all commands."""
        self._stream.clear()


class ServoPosition(_Servo[tuple[Vector, Vector]]):
    """`servo_jp`: references for the host law.

    Between two samples the last position is held with zero feed-forward. Before the first one is due, the position
    that the robot had when it arrived is held.
    """

    def __init__(self, robot: Robot, settings: MotionSettings, name: str = "servo_jp") -> None:
        super().__init__(name, settings)
        self._limits = [a.limits for a in robot.actuators]
        self._hold: Vector = ()
        self._step = [settings.step_factor * a.limits.velocity / robot.position_gain for a in robot.actuators]

    def accept(self, command: JointCommand, now: int, q: Vector) -> None:
        """Queue a reference (position, and velocity or zero).

        Raises:
            CommandRejected: the reference is not finite, beyond the travel or too large a step, or its stamp is stale,
                early or out of order.
        """
        self._queue(command.stamp, command.position, command.velocity or NO_VELOCITY, now, q)

    def _queue(self, stamp: int, positions: Vector | None, velocities: Vector, now: int, q: Vector) -> None:
        position = require_finite(self.name, positions, 5, "positions")
        velocity = require_finite(self.name, velocities, 5, "velocities")
        self._check_stamp(stamp, now)
        newest = self._stream.newest
        if newest is None:
            self._hold = q
        self._check_reach(position, q if newest is None else newest[0])
        self._stream.push(stamp, (position, velocity))

    def _check_reach(self, position: Vector, before: Vector) -> None:
        for k, limits in enumerate(self._limits):
            if not limits.lower <= position[k] <= limits.upper:
                raise CommandRejected(
                    self.name,
                    f"axis {k} beyond its travel",
                    value=position[k],
                    limit=(limits.lower, limits.upper),
                    remedy="stay within the limits of the robot file",
                )
            if abs(position[k] - before[k]) > self._step[k]:
                raise CommandRejected(
                    self.name,
                    f"axis {k}: step too large",
                    value=position[k] - before[k],
                    limit=self._step[k],
                    remedy="start at the measured position and send smaller steps, or use move_jp",
                )

    def step(self, now: int, q: Vector) -> Step:
        """Return the reference in force at the tick `now` [ns]."""
        reason, command, exact = self._stream.at(now)
        if command is None:
            return Step(reason, setpoint=(self._hold, NO_VELOCITY) if reason is Reason.MOVING else None)
        return Step(setpoint=command if exact else (command[0], NO_VELOCITY))


class ServoPose(ServoPosition):
    """`servo_cp`: a pose becomes actuator positions when it arrives; from there on it is like `servo_jp`."""

    def __init__(self, robot: Robot, settings: MotionSettings, inverse: Inverse) -> None:
        super().__init__(robot, settings, "servo_cp")
        self._inverse = inverse

    def accept(self, command: PoseCommand, now: int, q: Vector) -> None:  # type: ignore[override]
        """Queue a tip pose in {b}.

        Raises:
            CommandRejected: as in `ServoPosition.accept`.
            Sher3Error: the pose is out of reach.
        """
        require_finite(self.name, command.position, 3, "coordinates")
        require_finite(self.name, command.orientation, 4, "quaternion components")
        self._queue(command.stamp, self._inverse(command), NO_VELOCITY, now, q)


class ServoJointVelocity(_Servo[Vector]):
    """`servo_jv`: actuator velocities; the inverse velocity limits them and brakes before the ends."""

    def __init__(self, settings: MotionSettings) -> None:
        super().__init__("servo_jv", settings)

    def accept(self, command: JointCommand, now: int, q: Vector) -> None:
        """Queue actuator velocities (5,); raises CommandRejected: not finite, stale, early or out of order."""
        velocity = require_finite(self.name, command.velocity, 5, "velocities")
        self._check_stamp(command.stamp, now)
        self._stream.push(command.stamp, velocity)

    def step(self, now: int, q: Vector) -> Step:
        """Return the velocity in force at the tick `now` [ns]."""
        reason, command, _ = self._stream.at(now)
        return Step(reason, joints=command)


class ServoTwist(_Servo[Vector]):
    """`servo_cv`: tip twists in {b}."""

    def __init__(self, settings: MotionSettings) -> None:
        super().__init__("servo_cv", settings)

    def accept(self, command: TwistCommand, now: int, q: Vector) -> None:
        """Queue a twist (6,); raises CommandRejected: not finite, stale, early or out of order."""
        twist = require_finite(self.name, command.twist, 6, "components")
        self._check_stamp(command.stamp, now)
        self._stream.push(command.stamp, twist)

    def step(self, now: int, q: Vector) -> Step:
        """Return the twist in force at the tick `now` [ns]."""
        reason, command, _ = self._stream.at(now)
        return Step(reason, twist=command)
