"""The driver's eye on the axes: encoders and demand while they follow, rest while they are stopped."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_description.reasons import Action

from .feedback import Feedback
from .joint_checks import JointWatch
from .rest_check import RestCheck
from .settings import MotorDriverSettings
from .trips import StopLog, Trip
from .units import AxisScale


class MotionWatch:
    """Both checks.

    Attributes:
        joints: encoders and demand.
        rest: a stopped robot.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self.joints = JointWatch(scales, settings)
        self.rest = RestCheck(scales, settings)

    def check(self, feedback: Feedback, tick: int, following: bool, stop: StopLog, now: int) -> Trip | None:
        """Judge the feedback of tick number `tick` of a robot whose drives are `following`, or that is stopped."""
        if stop.first is None:
            return self.joints.check(feedback, tick) if following else None
        moved = self.rest.check(feedback.motor_position, stop.since, now)
        return moved if stop.action < Action.POWER_OFF else None

    def powers_off(self, stop: StopLog) -> bool:
        """Return whether the robot has braked and is to lose its power."""
        return stop.action is Action.POWER_OFF and self.rest.resting
