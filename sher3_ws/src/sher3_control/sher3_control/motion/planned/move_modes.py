"""The move modes: a planned motion to one goal, a short settling, then the robot is handed back."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from sher3_common.stamps import nanoseconds, seconds
from sher3_common.vectors import Vector
from sher3_description import Robot
from sher3_kinematics import RobotKinematics

from sher3_control.errors import CommandRejected
from sher3_control.motion.commands import JointCommand, PoseCommand
from sher3_control.motion.modes import Step, require_finite, require_timely
from sher3_control.motion.planned.tip_move import plan_tip_move
from sher3_control.motion.planned.trajectory import plan_joint_move
from sher3_control.motion.pose import tool_axis
from sher3_control.motion.speed_cap import PLANNED, Regime, axis_caps, planned_share, speed_cap
from sher3_control.settings import MotionSettings

Array = NDArray[np.float64]
PLACES_CHECKED = 33
"""Places along a straight line in actuator space, ends included, at which the delta must be in reach."""


class TimedPath(Protocol):
    """A planned motion over time."""

    @property
    def duration(self) -> float:
        """Length of the motion [s]."""

    def at(self, t: float) -> tuple[Array, Array]:
        """Return the reference positions (5,) and velocities (5,) at `t` [s] after the start."""


class _Move:
    """What both move modes share: they follow a plan.

    A move is finished when every axis is at the goal, or when the settling time after the planned motion is over.

    Attributes:
        name: CRTK name of the command.
        busy: a move is going on.
        cap, axis_caps: speed caps of tip and actuators (5,) that the next move is planned with.
    """

    def __init__(self, name: str, robot: Robot, kinematics: RobotKinematics, settings: MotionSettings) -> None:
        self.name = name
        self.busy = False
        self._kinematics = kinematics
        self._settings = settings
        acceleration = settings.acceleration * kinematics.acceleration
        self._change = (acceleration, acceleration / settings.ramp_time)
        self._tolerance = settings.settle_factor * np.array([a.load_encoder for a in robot.actuators])
        self._timely = nanoseconds(settings.ahead_limit)
        self.cap = speed_cap(settings, Regime(settings.regime))
        self.axis_caps = np.array(axis_caps(settings, self.cap, kinematics.velocity.tolist()))
        self._plan: TimedPath | None = None
        self._start = 0

    def _check(self, stamp: int, now: int) -> None:
        require_timely(self.name, stamp, now, self._timely, self._timely)
        if self.busy:
            raise CommandRejected(self.name, "busy with a former goal", remedy="wait until it is reached, or disable")

    @property
    def _velocity(self) -> Array:
        """Largest planned speed of the actuators (5,): a share of their limits, and `PLANNED` of their caps."""
        share = 1.0 if math.isinf(self.cap.linear) else PLANNED
        return np.asarray(np.minimum(self._settings.speed * self._kinematics.velocity, share * self.axis_caps))

    def _begin(self, plan: TimedPath, now: int) -> None:
        self._plan, self._start, self.busy = plan, now, True

    def step(self, now: int, q: Vector) -> Step:
        """Return the reference at the tick `now` [ns] with the robot at `q` (5,)."""
        if self._plan is None:
            return Step(finished=True)
        t = seconds(now - self._start)
        position, velocity = self._plan.at(t)
        setpoint = (tuple(position.tolist()), tuple(velocity.tolist()))
        late = t - self._plan.duration
        settled = late >= 0.0 and bool(np.all(np.abs(position - q) <= self._tolerance))
        finished = settled or late >= self._settings.settle_time
        if finished:
            self.reset()
        return Step(setpoint=setpoint, finished=finished)

    def reset(self) -> None:
        """Forget the goal."""
        self._plan, self.busy = None, False


class MoveJoints(_Move):
    """`move_jp`: a synchronised straight line in actuator space."""

    def __init__(self, robot: Robot, kinematics: RobotKinematics, settings: MotionSettings) -> None:
        super().__init__("move_jp", robot, kinematics, settings)

    def accept(self, command: JointCommand, now: int, q: Vector) -> None:
        """Plan the move from the measured positions `q` (5,) at the time `now` [ns].

        Raises:
            CommandRejected: the goal is not finite, the command unstamped, stale or early, or a move is going on.
            OutsideLimits, Unreachable: the goal or a place on the path is out of reach.
        """
        self._check(command.stamp, now)
        goal = np.array(require_finite(self.name, command.position, 5, "positions"))
        self._kinematics.require_within_limits(goal)
        velocity = self._velocity
        share = planned_share(self._kinematics, np.array(q), goal, velocity, self.cap)
        plan = plan_joint_move(np.array(q), goal, share * velocity, *self._change)
        for s in np.linspace(0.0, 1.0, PLACES_CHECKED):
            self._kinematics.delta.require(self._kinematics.delta.forward(plan.start[:3] + s * (goal - plan.start)[:3]))
        self._begin(plan, now)


class MoveTip(_Move):
    """`move_cp`: a straight line of the tip."""

    def __init__(self, robot: Robot, kinematics: RobotKinematics, settings: MotionSettings) -> None:
        super().__init__("move_cp", robot, kinematics, settings)

    def accept(self, command: PoseCommand, now: int, q: Vector) -> None:
        """Plan the move from the measured positions `q` (5,) at the time `now` [ns].

        Raises:
            CommandRejected: the goal is not finite or its quaternion has no unit length, the command is unstamped,
                stale or early, or a move is going on.
            OutsideLimits, Unreachable: the goal or a place on the path is out of reach.
        """
        self._check(command.stamp, now)
        position = np.array(require_finite(self.name, command.position, 3, "coordinates"))
        axis = tool_axis(require_finite(self.name, command.orientation, 4, "quaternion components"), self.name)
        settings, cap = self._settings, self.cap
        speeds = (min(settings.linear_speed, PLANNED * cap.linear), min(settings.angular_speed, PLANNED * cap.angular))
        caps = (self._velocity, *self._change)
        self._begin(plan_tip_move(self._kinematics, np.array(q), position, axis, caps, *speeds), now)
