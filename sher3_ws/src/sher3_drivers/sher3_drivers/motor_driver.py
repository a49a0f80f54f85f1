"""The motor driver: five CiA 402 drives in cyclic synchronous velocity over any CanLink.

One tick: `tick` (heartbeat, SYNC), `collect_positions` and `collect` (TPDOs, deadline), `command` (RPDOs). What must
not pass to the drives is refused here, what goes silent is stopped here: this is the last gate before the drives' own.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from sher3_description import ACTUATORS, Robot
from sher3_description.reasons import Action, Reason

from . import drive_objects as od
from .bus import CanLink, LinkGroup
from .can_errors import BusCondition, judge_error
from .cia402 import Command, Goal, State, next_command
from .drive_health import OPERATIONAL, DriveHealth, watch_drives
from .drive_setup import set_up_drives
from .errors import CommandRefused, DriverError
from .feedback import Feedback, TpdoCollector, Vector
from .frame import ERROR_FLAG, Frame, bundle, pack_frame
from .loop_watch import LoopWatch
from .motion_watch import MotionWatch
from .rpdo import RpdoPacker
from .settings import MotorDriverSettings
from .trips import StopLog, Trip
from .units import AxisScale
from .velocity_gate import velocity_counts

_WATCH_NS = 5_000_000
_BATCHES = 64
"""Batches of frames taken in before a SYNC at most: a flooded bus must not hold the loop."""


class MotorDriver:
    """Drives the five motors.

    Args:
        robot: the robot, for scales and limits.
        settings: channels and time limits.
        links: one link per channel, in the order of the settings.
        clock: time in ns, monotonic; stepped in tests.

    Attributes:
        goal: where the drives are being taken.
        stop: why the driver stopped by itself, if it did.
        health: one record per drive.
        loop: timing of the loop that calls this, and the age of the supervisor's heartbeat.
        motion: do both encoders and the demand of every axis agree, and does a stopped robot rest?
        collector: the TPDOs of the present tick, and those that came twice or with a wrong length.
        counters: frames and ticks that were lost or refused, by name.
        clock: time in ns.
        bus_conditions: health of every channel's controller.
    """

    def __init__(
        self,
        robot: Robot,
        settings: MotorDriverSettings,
        links: Sequence[CanLink],
        clock: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        settings.budgets()
        self.settings = settings
        self.goal = Goal.DISABLED
        self.stop = StopLog()
        self.health = [DriveHealth(name) for name in ACTUATORS]
        self.counters = dict.fromkeys(("incomplete", "refused", "ignored", "held", "error_frames"), 0)
        self.bus_conditions = [BusCondition.ACTIVE] * len(links)
        self.clock = clock
        self._group = LinkGroup(links)
        self._scales = [AxisScale.from_actuator(actuator) for actuator in robot.actuators]
        self._node_ids = [1 + i for i in range(len(ACTUATORS))]
        axes = [[ACTUATORS.index(name) for name in channel.drives] for channel in settings.channels]
        self._rpdos = RpdoPacker(axes, self._node_ids)
        self._settled_words: list[int | None] = []
        self.collector = TpdoCollector(self._scales, self._node_ids, settings.period)
        self._period_ns = round(settings.period * 1e9)
        self._feedback_ns = round(settings.feedback_limit * settings.period * 1e9)
        self._braking_time = max(a.limits.velocity / a.limits.acceleration for a in robot.actuators)
        self.loop = LoopWatch(settings)
        self.motion = MotionWatch(self._scales, settings)
        self._zero_age_ns = settings.zero_age * self._period_ns
        self._stop_age_ns = settings.stop_age * self._period_ns
        self._stamp = self._command_stamp = 0
        self._refused_last = False
        self._synced_at = self._started_at = self._heartbeat_at = self._watch_at = 0
        heartbeat = pack_frame(od.HEARTBEAT_BASE + settings.host_id, bytes([OPERATIONAL]))
        self._heartbeat, self._sync = [bundle([frame] * len(links)) for frame in (heartbeat, pack_frame(od.SYNC_ID))]
        self._reset_words = 0
        self._early: tuple[int, list[int]] | None = None
        self._running = False
        self._all_enabled = False
        self._dead_links = 0

    def configure(self, patience: float = 1.0) -> None:
        """Restart every drive, write its configuration, verify it by read-back, bring it to OPERATIONAL without power.

        Args:
            patience: longest wait for a drive to boot, s.

        Raises:
            OtherHost: another host is on the bus; nothing is sent.
            DriveSilent: a drive does not answer.
            DriveMismatch: a drive does not hold what it must. Nothing is enabled, no drive becomes OPERATIONAL.
        """
        set_up_drives(self._group.links, self.settings, self._scales, patience)

    def enable(self) -> None:
        """Take the drives to OPERATION ENABLED, over the next ticks.

        Raises:
            CommandRefused: a stop has not been reset, or a drive is in FAULT.
        """
        if self.stop.reason is not None:
            raise CommandRefused("enable is refused after a stop", value=self.stop.reason, remedy="reset first")
        faulty = [health.name for health in self.health if health.state is State.FAULT]
        if faulty:
            raise CommandRefused("enable is refused in FAULT", value=", ".join(faulty), remedy="reset first")
        if self.goal is not Goal.ENABLED:
            self.goal = Goal.ENABLED
            self._running = False
            self.motion.begin()
            self._restart_transitions()

    def disable(self) -> None:
        """Brake and take the power off, over the next ticks."""
        if self.goal is not Goal.DISABLED:
            self.goal = Goal.DISABLED
            self._restart_transitions()

    def hear_supervisor(self) -> None:
        """Take note of a heartbeat of the supervisor: without them an enabled robot stops."""
        self.loop.hear_supervisor(self.clock())

    def stop_for(self, trip: Trip, action: Action | None = None) -> None:
        """Brake now, all drives, and stay stopped until `reset`; the first trip is kept, the hardest action wins.

        Args:
            trip: what happened.
            action: how hard to stop, instead of what the trip's reason asks for.
        """
        first = self.stop.add(trip, self.clock(), action)
        self._early = None
        if first:
            self.goal = Goal.STOPPED
            self.motion.rest.begin()
            self._steer()

    def reset(self) -> None:
        """Clear a stop: once, on purpose, and only when there is one.

        Drives in FAULT get one rising edge of fault reset. They end up disabled; enabling is a request of its own.

        Raises:
            CommandRefused: there is nothing to reset.
        """
        if not self.needs_reset:
            raise CommandRefused("reset is refused: nothing is stopped", remedy="reset only after a stop or in FAULT")
        self.stop.clear()
        self.goal = Goal.DISABLED
        self._reset_words = 1
        self._restart_transitions()

    def _restart_transitions(self) -> None:
        now = self.clock()
        for health in self.health:
            health.state_since = now

    @property
    def needs_reset(self) -> bool:
        """Whether there is a stop to reset, or a drive in FAULT."""
        return self.stop.reason is not None or any(health.state is State.FAULT for health in self.health)

    @property
    def command_age(self) -> float:
        """Age of the newest command that went to the drives, s; 0 while they do not follow commands."""
        return (self._stamp - self._command_stamp) * 1e-9 if self.enabled and self._running else 0.0

    @property
    def dropped(self) -> int:
        """Frames the links could not deliver."""
        return sum(link.dropped for link in self._group.links)

    @property
    def enabled(self) -> bool:
        """Whether every drive follows velocity commands."""
        return self.goal is Goal.ENABLED and self._all_enabled

    def tick(self, stamp: int) -> None:
        """Begin the tick `stamp` (ns): take what came in between, send SYNC, and the host's heartbeat when it is due.

        The heartbeat has no timer of its own: when the loop that calls this hangs, it falls silent and the
        drives stop the robot.
        """
        for _ in range(_BATCHES):
            if not self._receive():
                break
        self.collector.begin()
        self._stamp = stamp
        now = self.clock()
        late = self.loop.tick(stamp, now)
        if late is not None and self.enabled:
            self.stop_for(late)
        self._started_at = self._started_at or now
        frames = self._sync
        if now >= self._heartbeat_at and not self.motion.deaf(self.stop):
            self._heartbeat_at = now + round(self.settings.host_heartbeat * 1e9)
            frames = self._heartbeat + frames
        self._synced_at = now
        self._send(frames)

    def collect_positions(self) -> Vector | None:
        """Return the load encoder positions (5,) of this tick as soon as they are in; None when one stays away."""
        return self.collector.load_position() if self._collect(self.collector.positions_mask) else None

    def collect(self) -> Feedback | None:
        """Return the whole feedback of this tick, None when a TPDO stays away; watch, and steer drives not enabled.

        A tick with a TPDO missing has no feedback: nothing is invented. After `missing_limit` of them the robot stops.
        """
        complete = self._collect(self.collector.all_mask)
        now = self.clock()
        if not complete or self.collector.statuswords != self._settled_words:
            self._judge_drives(complete, now)
        self._watch(now)
        feedback = self.collector.feedback(self._stamp) if complete else None
        if feedback is not None:
            self._stop_if(self.motion.check(feedback, self.enabled, self.stop, now))
            if self.motion.powers_off(self.stop):
                self.goal = Goal.DISABLED
        if not self.enabled:
            self._steer()
        self._follow_early()
        return feedback

    def _judge_drives(self, complete: bool, now: int) -> None:
        """Look at each drive: TPDOs that stay away, statuswords that are new."""
        missing = set() if complete else set(self.collector.missing())
        for axis, health in enumerate(self.health):
            if missing or health.missing:
                self._stop_if(health.on_tick(axis in missing, self.settings.missing_limit))
            word = self.collector.statuswords[axis]
            if word is not None and word != health.word and axis not in missing:
                self._stop_if(health.on_statusword(word, now))
        self._all_enabled = all([health.state is State.OPERATION_ENABLED for health in self.health])
        self.counters["incomplete"] += not complete
        self._settled_words = list(self.collector.statuswords) if complete else []

    def _collect(self, mask: int) -> bool:
        deadline = self._synced_at + self._feedback_ns
        while not self.collector.has(mask):
            left = deadline - self.clock()
            came = self._receive(left * 1e-9)
            if left <= 0 or not (came or self._group.waits):
                return self.collector.has(mask)
        return True

    def command(self, stamp: int, velocity: Sequence[float]) -> bool:
        """Send a velocity command (5,) of tick `stamp`; False when it is ignored because the drives are not enabled.

        A command may be early by less than `zero_age` periods, when this loop is late: it waits for its tick.

        Raises:
            CommandRefused: not five finite values within the velocity limits, or not of this or a near tick. Zero
                velocity is sent in its place.
        """
        try:
            counts = self._checked(stamp, velocity)
        except DriverError:
            self.counters["refused"] += 1
            self._refused_last, self._early = True, None
            self._steer()
            raise
        if not self.enabled:
            self.counters["ignored"] += 1
            return False
        if stamp > self._stamp:
            self._early = stamp, counts
        else:
            self._follow(counts)
        return True

    def _follow(self, counts: Sequence[int]) -> None:
        self._command_stamp, self._refused_last = self._stamp, False
        self._send_commands([Command.ENABLE_OPERATION] * len(counts), counts)

    def _follow_early(self) -> None:
        """Send a command that came before its tick, now that it is there."""
        if self._early is not None and self._early[0] <= self._stamp:
            (_, counts), self._early = self._early, None
            if self.enabled:
                self._follow(counts)

    def _checked(self, stamp: int, velocity: Sequence[float]) -> list[int]:
        age = self._stamp - stamp
        if not abs(age) < self.settings.zero_age * self._period_ns:
            limit = f"less than {self.settings.zero_age * self.settings.period * 1e3:g} ms either way"
            what = "age of the command"
            raise CommandRefused(what, value=f"{age * 1e-6:g} ms", limit=limit, remedy="check its sender")
        return velocity_counts(self._scales, velocity)

    def close(self) -> None:
        """Brake if the drives are enabled, take the power off and leave the bus; safe at any time, twice too."""
        if self.enabled:
            self.stop_for(Trip(Reason.DRIVER_CLOSED, "the driver was closed"))
            time.sleep(self._braking_time)
        self._steer(Command.DISABLE_VOLTAGE)
        self._group.close()

    def _receive(self, timeout: float = 0.0) -> bool:
        """Take in what waits, waiting at most `timeout` s for it; False when nothing came."""
        frames = self._group.receive(timeout)
        if frames:
            for channel, can_id, data in self.collector.take(frames):
                self._on_other(channel, can_id, data)
        if len(self._group.failures) > self._dead_links:
            self._dead_links = len(self._group.failures)
            for channel, error in self._group.failures.items():
                self.bus_conditions[channel] = BusCondition.OFF
                self._stop_if(Trip(Reason.LINK_LOST, str(error)))
        return bool(frames)

    def _on_other(self, channel: int, can_id: int, data: bytes) -> None:
        """Take a frame that is no TPDO: error frame, heartbeat or EMCY; the rest belongs to others."""
        if channel >= len(self.bus_conditions):
            return
        if can_id & ERROR_FLAG:
            self.counters["error_frames"] += 1
            link = self.settings.channels[channel].link
            self._stop_if(judge_error(self.bus_conditions, channel, link, Frame(can_id, data)))
            return
        node, service = can_id & 0x7F, can_id & 0x780
        if node in self._node_ids:
            health = self.health[node - 1]
            if service == od.HEARTBEAT_BASE:
                self._stop_if(health.on_heartbeat(data, self.clock()))
            elif service == od.EMCY_BASE:
                self._stop_if(health.on_emergency(data))

    def _stop_if(self, trip: Trip | None) -> None:
        if trip is not None:
            self.stop_for(trip)

    def _watch(self, now: int) -> None:
        """Look for what has gone silent: TPDOs and commands every tick, what has long limits every 5 ms."""
        if now >= self._watch_at:
            self._watch_at = now + _WATCH_NS
            for trip in watch_drives(self.health, self.goal, now, self._started_at, self.settings):
                self.stop_for(trip)
        if self.goal is Goal.ENABLED:
            self._watch_commands(now)

    def _watch_commands(self, now: int) -> None:
        """Watch supervisor and commands; the age of a command counts from the tick the drives became enabled in."""
        self._stop_if(self.loop.supervisor(now))
        if not self.enabled:
            for health in self.health:
                self._stop_if(health.fallen(self._running))
            return
        if not self._running:
            self._running = True
            self._command_stamp = self._stamp
        age = self._stamp - self._command_stamp
        if age >= self._stop_age_ns:
            reason = Reason.COMMAND_REFUSED if self._refused_last else Reason.COMMAND_STALE
            ticks, limit = age // self._period_ns, self.settings.stop_age
            self.stop_for(Trip(reason, f"no command for {ticks} ticks (limit {limit})", ticks, limit, "ticks"))
        elif age >= self._zero_age_ns:
            self.counters["held"] += 1
            self._steer()

    def _steer(self, word: Command | None = None) -> None:
        """Send zero velocity with, per drive, `word` or the next controlword towards the goal."""
        if word is not None:
            commands = [word] * len(self.health)
        else:
            commands = [next_command(h.state or State.NOT_READY_TO_SWITCH_ON, self.goal) for h in self.health]
        if self._reset_words and word is None:
            self._reset_words -= 1
            for axis, health in enumerate(self.health):
                if health.state is State.FAULT:
                    commands[axis] = Command.FAULT_RESET
        self._send_commands(commands, [0] * len(commands))

    def _send_commands(self, commands: Sequence[Command], velocity_counts: Sequence[int]) -> None:
        self.motion.demand.sent(velocity_counts)
        self._send(self._rpdos.frames(commands, velocity_counts))

    def _send(self, frames: bytes) -> None:
        """Send a bundle; a channel that cannot take its frames stops the robot on the others too."""
        for channel, error in self._group.send(frames):
            self.bus_conditions[channel] = BusCondition.OFF
            if self.stop.add(Trip(Reason.LINK_LOST, str(error)), self.clock()):
                self.goal = Goal.STOPPED
                self.motion.rest.begin()
