"""The driver's eye on the axes: echo, encoders and demand while they follow, rest while they are stopped."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_common.reasons import Action, Reason

from sher3_drivers.canopen.cia402 import Goal
from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.demand import DemandCheck
from sher3_drivers.watches.fingerprint import FingerprintCheck
from sher3_drivers.watches.frozen import FrozenCheck
from sher3_drivers.watches.joints import JointWatch
from sher3_drivers.watches.position import PositionWatch
from sher3_drivers.watches.rest import RestCheck
from sher3_drivers.watches.trips import StopLog, Trip


class MotionWatch:
    """The checks of a moving robot and of a stopped one.

    Attributes:
        demand: velocity demand sent against the one the drives say they execute.
        fingerprint: reports of another tick or another axis.
        frozen: reports that repeat while their axis was told to go.
        joints: encoders against each other and against the demand.
        position: axes against the sum of the commands sent.
        rest: a robot that is stopped or disabled.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self.demand = DemandCheck(scales, settings)
        self.fingerprint = FingerprintCheck(scales, settings)
        self.frozen = FrozenCheck(scales, settings)
        self.joints = JointWatch(scales, settings)
        self.position = PositionWatch(scales, settings)
        self.rest = RestCheck(scales, settings)
        self._stamp: int | None = None
        self._held = self.demand.newest
        self._followed = False
        self._goal, self._rest_since = Goal.DISABLED, 0

    def begin(self) -> None:
        """Start afresh with axes that are about to follow."""
        self.demand.begin()
        self.fingerprint.begin()
        self.frozen.begin()
        self.position.begin()
        self.rest.begin()
        self._stamp, self._followed = None, False

    def sync(self) -> None:
        """Take note of a SYNC: the newest command on the wire is what the drives have executed up to it."""
        self._held = self.demand.newest
        self.fingerprint.sync(self._held)

    def check(self, feedback: DriveFeedback, goal: Goal, following: bool, stop: StopLog, now: int) -> Trip | None:
        """Judge the feedback of a robot in any state.

        Args:
            feedback: of this tick.
            goal: where the drives are being taken.
            following: every drive follows commands.
            stop: why the robot is stopped, if it is.
            now: time, ns.
        """
        since = self._since(feedback.stamp)
        self.position.follow(feedback, self._held, since)
        if stop.first is not None or goal is Goal.DISABLED:
            return self._at_rest(goal, stop, now)
        self._goal = goal
        if not following:
            return self.position.judge()
        if not self._followed:
            # Whatever compares one tick with the one before begins with the first one in which the drives follow.
            self._followed, since = True, 0.0
        return (
            self.demand.check(feedback.velocity_demand)
            or self.fingerprint.check(feedback.velocity_demand)
            or self.frozen.check(feedback, self._held, since)
            or self.joints.check(feedback, since)
            or self.position.judge()
        )

    def _at_rest(self, goal: Goal, stop: StopLog, now: int) -> Trip | None:
        """Judge a robot that is stopped, or disabled, once its axes have had the time to brake."""
        stopped = stop.first is not None
        state = Goal.STOPPED if stopped else goal
        if state is not self._goal:
            self._goal, self._rest_since = state, now
            self.rest.begin()
        if self.rest.begins_now(stop.since if stopped else self._rest_since, now):
            self.position.begin()
            return None
        reason = Reason.STOP_NOT_OBEYED if stopped else Reason.MOVED_DISABLED
        return self.rest.check(self.position.moved, reason)

    def _since(self, stamp: int) -> float:
        """Return the time since the last feedback, s; 0 for the first.

        Lost ticks count, because the drives go on during them.
        """
        before, self._stamp = self._stamp, stamp
        return 0.0 if before is None else max(0, stamp - before) * 1e-9

    def deaf(self, stop: StopLog) -> bool:
        """Return whether a drive does not listen, or perhaps not: then only silence of the host stops it."""
        if stop.first is None:
            return False
        return bool(stop.first.axes) or self.frozen.blind or self.rest.disobeyed

    def powers_off(self, stop: StopLog) -> bool:
        """Return whether the robot has braked and is to lose its power now."""
        return stop.action is Action.POWER_OFF and self.rest.resting
