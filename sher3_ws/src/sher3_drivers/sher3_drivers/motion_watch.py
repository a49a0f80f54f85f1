"""The driver's eye on the axes: echo, encoders and demand while they follow, rest while they are stopped."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_description.reasons import Action, Reason

from .demand_check import DemandCheck
from .feedback import Feedback
from .frozen_check import FrozenCheck
from .joint_checks import JointWatch
from .rest_check import RestCheck
from .settings import MotorDriverSettings
from .trips import StopLog, Trip
from .units import AxisScale


class MotionWatch:
    """Both checks.

    Attributes:
        demand: what was sent, and what the drives say they execute.
        frozen: reports that stand while the axis was told to go.
        joints: encoders and demand.
        rest: a stopped robot.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self.demand = DemandCheck(scales, settings)
        self.frozen = FrozenCheck(scales, settings)
        self.joints = JointWatch(scales, settings)
        self.rest = RestCheck(scales, settings)
        self._stamp: int | None = None

    def begin(self) -> None:
        """Start afresh with axes that are about to follow."""
        self.demand.begin()
        self.frozen.begin()
        self._stamp = None

    def check(self, feedback: Feedback, following: bool, stop: StopLog, now: int) -> Trip | None:
        """Judge the feedback of a robot whose drives are `following`, or that is stopped."""
        if stop.first is None:
            if not following:
                return None
            since = self._since(feedback.stamp)
            return (
                self.demand.check(feedback.velocity_demand)
                or self.frozen.check(feedback, self.demand.newest, since)
                or self.joints.check(feedback, since)
            )
        moved = self.rest.check(feedback.motor_position, stop.since, now)
        return moved if stop.action < Action.POWER_OFF else None

    def _since(self, stamp: int) -> float:
        """Return the time since the last feedback, s, 0 for the first: lost ticks are time in which drives go on."""
        before, self._stamp = self._stamp, stamp
        return 0.0 if before is None else max(0, stamp - before) * 1e-9

    def deaf(self, stop: StopLog) -> bool:
        """Return whether a drive does not listen, or perhaps not: then only silence of the host stops it."""
        deaf = stop.code is Reason.DRIVE_DISOBEYS or self.frozen.blind or self.rest.disobeyed
        return deaf and stop.first is not None

    def powers_off(self, stop: StopLog) -> bool:
        """Return whether the robot has braked and is to lose its power."""
        return stop.action is Action.POWER_OFF and self.rest.resting
