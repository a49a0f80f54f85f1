"""The driver's eye on the axes: echo, encoders and demand while they follow, ramp and rest while they are stopped.

Every check judges every axis in every tick, and there is no time between two of them: the sum of the commands and the
echo are followed on through the ramp of a stop, and the rest begins where the ramp ended. An axis that is not heard in
a tick is taken to be where its commands put it, until it is heard again: so it shields no other one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from operator import add

from sher3_common.reasons import Action, Reason
from sher3_common.vectors import Vector

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
from sher3_drivers.watches.trips import StopLog, Trip, together


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
        self._seen: DriveFeedback | None = None
        self._held = self.demand.newest
        self._followed = False
        self._goal, self._rest_since = Goal.DISABLED, 0
        self._accused: set[int] = set()

    def begin(self) -> None:
        """Start afresh with axes that are about to follow."""
        self.demand.begin()
        self.fingerprint.begin()
        self.frozen.begin()
        self.position.begin()
        self.rest.begin()
        self._accused.clear()
        self._stamp, self._followed = None, False

    def sync(self) -> None:
        """Take note of a SYNC: the newest command on the wire is what the drives have executed up to it, or a ramp."""
        self.demand.sync()
        self._held = self.demand.newest
        self.fingerprint.sync(self._held)

    def check(
        self,
        feedback: DriveFeedback,
        goal: Goal,
        following: bool,
        stop: StopLog,
        now: int,
        unheard: Collection[int] = (),
    ) -> Trip | None:
        """Judge the feedback of a robot in any state.

        Args:
            feedback: of this tick.
            goal: where the drives are being taken.
            following: every drive follows commands.
            stop: why the robot is stopped, if it is.
            now: time, ns.
            unheard: numbers of the axes of which there is no report in this tick. Before the first whole feedback
                nothing is judged.
        """
        if unheard and self._seen is None:
            return None
        since = self._since(feedback.stamp)
        if unheard:
            feedback = self._carried(feedback, unheard, since)
        self._seen = feedback
        if stop.first is not None or goal is Goal.DISABLED:
            return self._at_rest(feedback, goal, stop, now, since)
        self.position.follow(feedback, self._held, since)
        self._goal = goal
        if not following:
            return self.position.judge()
        if not self._followed:
            # Whatever compares one tick with the one before begins with the first one in which the drives follow.
            self._followed, since = True, 0.0
        return together(
            (
                self.demand.check(feedback.velocity_demand),
                self.fingerprint.check(feedback.velocity_demand, unheard),
                self.frozen.check(feedback, self._held, since, unheard),
                self.joints.check(feedback, since),
                self.position.judge(),
            )
        )

    def _carried(self, heard: DriveFeedback, unheard: Collection[int], since: float) -> DriveFeedback:
        """Return a feedback in which axes not heard have obeyed their commands since the one before."""
        before = heard if self._seen is None else self._seen
        steps = tuple([held * since for held in self._held])

        def fill(reports: Vector, guesses: Iterable[float]) -> Vector:
            return tuple(
                [guess if n in unheard else r for n, (r, guess) in enumerate(zip(reports, guesses, strict=True))]
            )

        return heard._replace(
            load_position=fill(heard.load_position, map(add, before.load_position, steps)),
            motor_position=fill(heard.motor_position, map(add, before.motor_position, steps)),
            effort=fill(heard.effort, before.effort),
            velocity_demand=fill(heard.velocity_demand, self._held),
        )

    def _at_rest(self, feedback: DriveFeedback, goal: Goal, stop: StopLog, now: int, since: float) -> Trip | None:
        """Judge a robot that is stopped, or disabled: its ramps, and then its rest."""
        first = stop.first
        state = goal if first is None else Goal.STOPPED
        if state is not self._goal:
            self._goal, self._rest_since = state, now
            self._accused = set(() if first is None else first.axes)
            self.rest.begin()
            self.position.brake()
        self.position.follow(feedback, self._held, since)
        reason = Reason.MOVED_DISABLED if first is None else Reason.STOP_NOT_OBEYED
        powered = goal is Goal.STOPPED
        self._followed = self._followed and powered  # what compares one tick with the next has no gap
        trip = together(
            (
                self.position.judge(reason),
                self.demand.check(feedback.velocity_demand) if powered else None,
                self.joints.check(feedback, since) if self._followed else None,
                self.rest.check(self.position.moved, reason),
            )
        )
        if self.rest.begins_now(self._rest_since if first is None else stop.since, now):
            self._accused.clear()
            self.position.brake(rests=True)
        return self._accuse(trip)

    def _accuse(self, trip: Trip | None) -> Trip | None:
        """Return an objection to a robot that does not stop, unless it has been made: every axis once for each rest."""
        if trip is None or self._accused.issuperset(trip.axes):
            return None
        self.rest.disobeyed = True
        self._accused.update(trip.axes)
        return trip

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
        """Return whether the robot has braked and is to lose its power now: whatever still moves is not told to."""
        return stop.action is Action.POWER_OFF and self.demand.braked
