"""The motor driver: five CiA 402 drives in cyclic synchronous velocity over any CanLink.

One tick: `tick` (heartbeat, SYNC), `collect_positions` and `collect` (TPDOs, deadline), `command` (RPDOs). What must
not pass to the drives is refused here, and what falls silent is stopped here: this is the last gate before the
drives' own. The driver puts four parts in order: the session (`drive.session`) decides, the wire (`drive.wire`)
carries frames, the gate (`drive.command_gate`) admits commands, the watches (`watches.stop`) object.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from sher3_common.reasons import Action, Reason
from sher3_common.vectors import Vector
from sher3_description import ACTUATORS, Robot

from sher3_drivers.bus.link import CanLink
from sher3_drivers.canopen.cia402 import Controlword, Goal
from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.drive.command_gate import CommandGate
from sher3_drivers.drive.session import DriveSession
from sher3_drivers.drive.setup import set_up_drives
from sher3_drivers.drive.speed_limits import SpeedLimits
from sher3_drivers.drive.wire import DriveWire, Failures
from sher3_drivers.errors import CommandRefused, DriverError
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.drives import DriveHealth
from sher3_drivers.watches.stop import StopWatches
from sher3_drivers.watches.trips import StopLog, Trip

_BATCHES = 64
"""Batches of frames taken in before a SYNC at most: a flooded bus must not hold the loop. A tick needs one or two."""


class MotorDriver:
    """Drives the five motors.

    Args:
        robot: the robot, for scales and limits.
        settings: channels and time limits.
        links: one link per channel, in the order of the settings.
        clock: time in ns, monotonic; stepped in tests.

    Attributes:
        settings: channels and time limits.
        clock: time in ns.
        scales: scales of the five axes.
        session: goal, stop and recovery.
        wire: frames in and out.
        limits: speed caps of the regime, in the gate and in the drives.
        gate: the check of commands, and their age.
        watches: whatever may stop the robot.
        absent: optional objects that each drive does not have, by its name.
        counters: ticks and commands that were lost, refused or replaced, by name.

    Raises:
        BusLoadError: the configured cycle does not fit the bus.
        ScaleError: a number of the robot does not fit the objects of a drive.
    """

    def __init__(
        self,
        robot: Robot,
        settings: MotorDriverSettings,
        links: Sequence[CanLink],
        clock: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        settings.budgets()
        health = [DriveHealth(name) for name in ACTUATORS]
        self.settings, self.clock = settings, clock
        self.scales = tuple(AxisScale.from_actuator(actuator) for actuator in robot.actuators)
        self.session = DriveSession(health, settings.report_limit, settings.status_reports)
        self.wire = DriveWire(links, settings, self.scales)
        self.gate = CommandGate(self.scales, settings)
        self.limits = SpeedLimits(self.scales, settings)
        self.watches = StopWatches(health, self.scales, settings)
        self.absent: dict[str, tuple[str, ...]] = {}
        self.counters = dict.fromkeys(("incomplete", "refused", "ignored", "held"), 0)
        self._braking_time = max(a.limits.velocity / a.limits.acceleration for a in robot.actuators)

    @property
    def goal(self) -> Goal:
        """Where the drives are being taken."""
        return self.session.goal

    @property
    def stop(self) -> StopLog:
        """Why the driver stopped by itself, if it did."""
        return self.session.stop

    @property
    def enabled(self) -> bool:
        """Whether every drive follows velocity commands."""
        return self.session.enabled

    @property
    def needs_reset(self) -> bool:
        """Whether there is a stop to reset, or a drive in FAULT."""
        return self.session.needs_reset

    @property
    def command_age(self) -> float:
        """Age of the newest command that went to the drives, s; 0 while they do not follow commands."""
        return self.gate.age * 1e-9 if self.enabled and self.gate.following else 0.0

    # Start, stop and recovery.

    def configure(self, patience: float = 1.0) -> None:
        """Restart every drive, write its configuration, verify it by read-back, bring it to OPERATIONAL without power.

        Args:
            patience: longest wait for a drive to boot, s.

        Raises:
            OtherHost: another host is on the bus; nothing is sent.
            DriveSilent: a drive does not answer.
            DriveMismatch: a drive does not hold what it must. Nothing is enabled, no drive becomes OPERATIONAL.
        """
        self.absent = set_up_drives(self.wire.links, self.settings, self.limits.scales(), patience)

    def enable(self) -> None:
        """Take the drives to OPERATION ENABLED, over the next ticks.

        Raises:
            CommandRefused: a stop has not been reset, or a drive is in FAULT without being reset.
        """
        if self.session.enable(self.clock()):
            self.gate.begin()
            self.watches.motion.begin()

    def disable(self) -> None:
        """Brake and take the power off, over the next ticks."""
        self.session.disable(self.clock())

    def stop_for(self, trip: Trip, action: Action | None = None) -> None:
        """Brake now, all drives, and stay stopped until `reset`; the first trip is kept, the hardest action wins.

        Args:
            trip: what happened.
            action: how hard to stop, instead of what the trip's reason asks for.
        """
        first = self.session.stop_for(trip, self.clock(), action)
        self.gate.forget()
        if first:
            self.watches.motion.rest.begin()
        if first or trip.axes:
            self._steer()

    def reset(self) -> None:
        """Clear a stop: once, on purpose, and only when there is one.

        Drives in FAULT get `fault reset` until they have left it, those that restarted are configured again once the
        others have lost their power. All end up disabled; enabling is a request of its own.

        Raises:
            CommandRefused: there is nothing to reset.
        """
        self.session.reset(self.clock())
        self.limits.recover(self.clock())

    def close(self) -> None:
        """Brake if the drives are enabled, take the power off and leave the bus; safe at any time, twice too."""
        if self.enabled:
            self.stop_for(Trip(Reason.DRIVER_CLOSED, "the driver was closed"))
            time.sleep(self._braking_time)
        self._send([Controlword.DISABLE_VOLTAGE] * len(ACTUATORS))
        self.wire.close()

    # One tick.

    def hear_regime(self, text: str) -> None:
        """Take the settings of the motion modes, which name the speed regime."""
        self.limits.hear(text, self.clock())

    def hear_supervisor(self) -> None:
        """Take note of a heartbeat of the supervisor: without them an enabled robot stops."""
        self.watches.loop.hear_supervisor(self.clock())

    def tick(self, stamp: int) -> None:
        """Begin the tick `stamp` (ns): take in what came since the last one, send SYNC and, when due, the heartbeat."""
        for _ in range(_BATCHES):
            if not self._receive():
                break
        if self.session.may_set_up:
            self._set_up_again()
        self.gate.stamp = stamp
        now = self.clock()
        late = self.watches.loop.tick(stamp, now)
        if late is not None and self.enabled:
            self.stop_for(late)
        self.watches.drives.begin(now)
        self.watches.motion.sync()
        self._note_failures(self.wire.sync(now, audible=not self.watches.motion.deaf(self.stop)))
        self._limit_speeds(now)

    def _limit_speeds(self, now: int) -> None:
        """Go on with giving the drives the caps of their regime."""
        requests = self.limits.frames(now)
        if requests:
            self._note_failures(self.wire.ask(requests))
        self._stop_if(self.limits.overdue(now))
        self.gate.caps = self.limits.caps

    def collect_positions(self) -> Vector | None:
        """Return the load encoder positions (5,) [m, rad] of this tick as soon as they are in; None without one."""
        collector = self.wire.collector
        return collector.load_position() if self._collect(collector.positions_mask) else None

    def collect(self) -> DriveFeedback | None:
        """Return the whole feedback of this tick, None when a TPDO stays away; watch, and steer drives not enabled.

        A tick with a TPDO missing has no feedback: nothing is invented. After `missing_limit` of them the robot stops.
        """
        collector, session = self.wire.collector, self.session
        complete = self._collect(collector.all_mask)
        if collector.end():
            for trip in session.unbelievable(collector.invalid):
                self.stop_for(trip)
        now = self.clock()
        if not complete or session.is_news(collector.statuswords):
            self._judge_drives(complete, now)
        self._watch(now)
        feedback = collector.feedback(self.gate.stamp) if complete else None
        self._judge_motion(feedback, now)
        if not session.enabled:
            self._steer()
        self._follow_early()
        return feedback

    def command(self, stamp: int, velocity: Sequence[float]) -> bool:
        """Send a velocity command (5,) [m/s, rad/s] of tick `stamp`; False when it is ignored: drives not enabled.

        A command may be early by less than `zero_age` periods, when this loop is late: it waits for its tick.

        Raises:
            CommandRefused: not five finite values within the velocity limits, or not of this or a near tick. Zero
                velocity is sent in its place.
        """
        try:
            counts = self.gate.check(stamp, velocity)
        except CommandRefused:
            self.counters["refused"] += 1
            self.gate.refuse()
            self._steer()
            raise
        if not self.session.enabled:
            self.counters["ignored"] += 1
            return False
        if stamp > self.gate.stamp:
            self.gate.keep(stamp, counts)
        else:
            self._follow(counts)
        return True

    # Frames in.

    def _collect(self, mask: int) -> bool:
        """Wait for the TPDOs of `mask` until their deadline; return whether they are in."""
        wire = self.wire
        while not wire.collector.has(mask):
            left = wire.time_left(self.clock())
            came = self._receive(left * 1e-9)
            if left <= 0 or not (came or wire.waits):
                return wire.collector.has(mask)
        return True

    def _receive(self, timeout: float = 0.0) -> bool:
        """Take in what waits, waiting at most `timeout` s for it; False when nothing came."""
        bus = self.watches.bus
        others = self.wire.receive(timeout)
        for channel, can_id, data in others or ():
            self._stop_if(self.limits.answer(channel, can_id, data))
            self._stop_if(bus.hear(channel, can_id, data, self.clock()))
        broken = self.wire.broken
        if broken and bus.more_broken(len(broken)):
            for channel, error in broken.items():
                self.stop_for(bus.lose(channel, error))
        return others is not None

    def _judge_drives(self, complete: bool, now: int) -> None:
        """Look at each drive: TPDOs that stay away, statuswords that are new."""
        collector = self.wire.collector
        missing = frozenset() if complete else frozenset(collector.missing())
        for trip in self.session.judge(collector.statuswords, missing, self.settings.missing_limit, now):
            self.stop_for(trip)
        self.session.cut_unheard()
        self.counters["incomplete"] += not complete

    def _judge_motion(self, feedback: DriveFeedback | None, now: int) -> None:
        """Judge every axis in every tick: one that is not heard must not shield the others."""
        motion, session, collector = self.watches.motion, self.session, self.wire.collector
        seen = collector.newest(self.gate.stamp) if feedback is None else feedback
        unheard = collector.missing() if feedback is None else []
        self._stop_if(motion.check(seen, session.goal, session.enabled, session.stop, now, unheard))
        if motion.powers_off(session.stop):
            session.power_off()

    def _set_up_again(self) -> None:
        """Configure every drive again in a recovery: one of them restarted. The loop is held meanwhile, without power.

        A drive that does not answer, or does not hold what it must, stops the robot again.
        """
        try:
            self.configure()
        except DriverError as error:
            self.stop_for(Trip(Reason.DRIVE_RESTARTED, f"not configured again: {error}"))
            return
        self.session.set_up(self.clock())
        self.wire.collector.forget()

    # Watching.

    def _stop_if(self, trip: Trip | None) -> None:
        if trip is not None:
            self.stop_for(trip)

    def _watch(self, now: int) -> None:
        """Look for what has fallen silent: drives, and while they are to be enabled supervisor and commands."""
        session = self.session
        if self.watches.drives.is_due(now):
            for trip in self.watches.drives.check(session.heading, now):
                self.stop_for(trip)
        if session.goal is Goal.ENABLED:
            self._stop_if(self.watches.loop.supervisor(now))
            for trip in session.objections():
                self.stop_for(trip)
            self._watch_commands()

    def _watch_commands(self) -> None:
        """Watch the age of commands to drives that are enabled, and the way there of those that are not yet."""
        if not self.session.enabled:
            for drive in self.session.drives:
                self._stop_if(drive.fallen(self.gate.following))
            return
        gate = self.gate
        stale = gate.watch()
        if stale is not None:
            self.stop_for(stale)
        elif gate.late:
            self.counters["held"] += 1
            self._steer()

    # Frames out.

    def _follow(self, counts: Sequence[int]) -> None:
        self.gate.passed()
        self._send([Controlword.ENABLE_OPERATION] * len(counts), counts)

    def _follow_early(self) -> None:
        """Send a command that came before its tick, now that its tick is there."""
        counts = self.gate.take_due()
        if counts is not None and self.enabled:
            self._follow(counts)

    def _steer(self) -> None:
        """Send zero velocity and the next controlword towards the goal."""
        self._send(self.session.next_words())

    def _send(self, words: Sequence[Controlword], counts: Sequence[int] = (0,) * len(ACTUATORS)) -> None:
        demand = self.watches.motion.demand
        if self.goal is Goal.ENABLED:
            demand.sent(counts)
        else:
            demand.stopped()
        self._note_failures(self.wire.send(words, counts))

    def _note_failures(self, failures: Failures) -> None:
        """Stop the robot on the other channels when one cannot take its frames."""
        for channel, error in failures:
            if self.session.stop_for(self.watches.bus.lose(channel, error), self.clock()):
                self.watches.motion.rest.begin()
