"""The motor driver: five CiA 402 drives in cyclic synchronous velocity over any CanLink.

One tick: `tick` (heartbeat, SYNC), `collect_positions` and `collect` (TPDOs, deadline), `command` (RPDOs). What must
not pass to the drives is refused here, what goes silent is stopped here: this is the last gate before the drives' own.
"""

from __future__ import annotations

import struct
import time
from collections.abc import Callable, Sequence

from sher3_description import ACTUATORS, Robot

from . import drive_objects as od
from .bus import CanLink, LinkGroup
from .can_errors import BusCondition, decode_error
from .cia402 import Command, Goal, State, next_command
from .drive_health import OPERATIONAL, DriveHealth, StopLog
from .drive_setup import set_up_drives
from .errors import CommandRefused, DriverError, LinkError
from .feedback import Feedback, TpdoCollector, Vector
from .frame import ERROR_FLAG, HEADER_FORMAT, Frame, pack_frame
from .settings import MotorDriverSettings
from .units import AxisScale

_RPDO = struct.Struct(f"<{HEADER_FORMAT}Hi2x")
_WATCH_NS = 5_000_000
_BATCHES = 64
"""Batches of frames taken in before a SYNC at most: a flooded bus must not hold the loop."""

_SETTLED = {Goal.ENABLED: State.OPERATION_ENABLED, Goal.DISABLED: State.SWITCH_ON_DISABLED}


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
        collector: the TPDOs of the present tick, and those that came twice or with a wrong length.
        counters: frames and ticks that were lost or refused, by name.
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
        self._clock = clock
        self._group = LinkGroup(links)
        self._scales = [AxisScale.from_actuator(actuator) for actuator in robot.actuators]
        self._node_ids = [1 + i for i in range(len(ACTUATORS))]
        self._axes = [[ACTUATORS.index(name) for name in channel.drives] for channel in settings.channels]
        self.collector = TpdoCollector(self._scales, self._node_ids, settings.period)
        self._period_ns = round(settings.period * 1e9)
        self._feedback_ns = round(settings.feedback_limit * settings.period * 1e9)
        self._braking_time = max(a.limits.velocity / a.limits.acceleration for a in robot.actuators)
        self._stamp = 0
        self._ticks = self._command_tick = 0
        self._synced_at = self._started_at = self._heartbeat_at = self._watch_at = 0
        self._heartbeat = pack_frame(od.HEARTBEAT_BASE + settings.host_id, bytes([OPERATIONAL]))
        self._sync = pack_frame(od.SYNC_ID)
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
            self._restart_transitions()

    def disable(self) -> None:
        """Brake and take the power off, over the next ticks."""
        if self.goal is not Goal.DISABLED:
            self.goal = Goal.DISABLED
            self._restart_transitions()

    def quick_stop(self, reason: str) -> None:
        """Brake now, all drives, and stay stopped until `reset`; the first reason is kept."""
        self.stop.add(reason, self._clock())
        self._early = None
        if self.goal is not Goal.STOPPED:
            self.goal = Goal.STOPPED
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
        now = self._clock()
        for health in self.health:
            health.state_since = now

    @property
    def needs_reset(self) -> bool:
        """Whether there is a stop to reset, or a drive in FAULT."""
        return self.stop.reason is not None or any(health.state is State.FAULT for health in self.health)

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
        self._ticks += 1
        now = self._clock()
        self._started_at = self._started_at or now
        burst = self._sync
        if now >= self._heartbeat_at:
            self._heartbeat_at = now + round(self.settings.host_heartbeat * 1e9)
            burst = self._heartbeat + burst
        self._synced_at = now
        self._send([burst] * len(self._axes))

    def collect_positions(self) -> Vector | None:
        """Return the load encoder positions (5,) of this tick as soon as they are in; None when one stays away."""
        return self.collector.load_position() if self._collect(self.collector.positions_mask) else None

    def collect(self) -> Feedback | None:
        """Return the whole feedback of this tick, None when a TPDO stays away; watch, and steer drives not enabled.

        A tick with a TPDO missing has no feedback: nothing is invented. After `missing_limit` of them the robot stops.
        """
        complete = self._collect(self.collector.all_mask)
        now = self._clock()
        missing = set() if complete else set(self.collector.missing())
        for axis, health in enumerate(self.health):
            if missing or health.missing:
                health.on_tick(axis in missing)
            word = self.collector.statuswords[axis]
            if word is not None and word != health.word and axis not in missing:
                self._stop_if(health.on_statusword(word, now))
        self._all_enabled = all([health.state is State.OPERATION_ENABLED for health in self.health])
        self.counters["incomplete"] += not complete
        self._watch(now)
        if not self.enabled:
            self._steer()
        self._follow_early()
        return self.collector.feedback(self._stamp) if complete else None

    def _collect(self, mask: int) -> bool:
        deadline = self._synced_at + self._feedback_ns
        while not self.collector.has(mask):
            left = deadline - self._clock()
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
            self._early = None
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
        self._command_tick = self._ticks
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
        if len(velocity) != len(self._scales):
            what = "number of velocities"
            raise CommandRefused(what, value=len(velocity), limit=len(self._scales), remedy="send five")
        counts = []
        for scale, value in zip(self._scales, velocity, strict=True):
            if not abs(value) <= scale.velocity_limit * (1.0 + 1e-9):  # a NaN compares false
                what, remedy = f"{scale.name}: velocity command", "limit it at its source"
                raise CommandRefused(what, value=value, limit=scale.velocity_limit, remedy=remedy)
            counts.append(scale.velocity_counts(value))
        return counts

    def close(self) -> None:
        """Brake if the drives are enabled, take the power off and leave the bus; safe at any time, twice too."""
        if self.enabled:
            self.quick_stop("the driver was closed")
            time.sleep(self._braking_time)
        self._steer(Command.DISABLE_VOLTAGE)
        self._group.close()

    def _receive(self, timeout: float = 0.0) -> bool:
        """Take in what waits, waiting at most `timeout` s for it; False when nothing came."""
        received = self._group.receive(timeout)
        for channel, frames in received:
            for can_id, data in self.collector.take(frames):
                self._on_other(channel, can_id, data)
        if len(self._group.failures) > self._dead_links:
            self._dead_links = len(self._group.failures)
            for channel, error in self._group.failures.items():
                self.bus_conditions[channel] = BusCondition.OFF
                self._stop_if(str(error))
        return bool(received)

    def _on_other(self, channel: int, can_id: int, data: bytes) -> None:
        """Take a frame that is no TPDO: error frame, heartbeat or EMCY; the rest belongs to others."""
        if can_id & ERROR_FLAG:
            self._on_error(channel, Frame(can_id, data))
            return
        node, service = can_id & 0x7F, can_id & 0x780
        if node in self._node_ids:
            health = self.health[node - 1]
            if service == od.HEARTBEAT_BASE:
                self._stop_if(health.on_heartbeat(data, self._clock()))
            elif service == od.EMCY_BASE:
                self._stop_if(health.on_emergency(data))

    def _on_error(self, channel: int, frame: Frame) -> None:
        report = decode_error(frame)
        self.counters["error_frames"] += 1
        if report is not None and report.condition is not None:
            self.bus_conditions[channel] = report.condition
            if report.condition >= BusCondition.PASSIVE:
                self._stop_if(f"{self.settings.channels[channel].link}: {report.text}")

    def _stop_if(self, reason: str | None) -> None:
        if reason is not None:
            self.quick_stop(reason)

    def _watch(self, now: int) -> None:
        """Look for what has gone silent: TPDOs and commands every tick, what has long limits every 5 ms."""
        settings = self.settings
        for health in self.health:
            if health.missing >= settings.missing_limit:
                self._stop_if(f"{health.name}: no TPDO for {health.missing} ticks (limit {settings.missing_limit})")
        if now >= self._watch_at:
            self._watch_at = now + _WATCH_NS
            self._watch_drives(now)
        self._watch_commands()

    def _watch_drives(self, now: int) -> None:
        """Look for drives whose heartbeat stays away or that do not get where they should."""
        settings = self.settings
        for health in self.health:
            silence = (now - (health.heard_at or self._started_at)) * 1e-9
            if silence > settings.drive_heartbeat_limit:
                self._stop_if(f"{health.name}: no heartbeat for {silence:.3f} s ({settings.drive_heartbeat_limit:g} s)")
            wanted = _SETTLED.get(self.goal)
            # A drive whose first statusword is still on its way has no state yet, and no time of its own.
            stuck = (now - (health.state_since or self._started_at)) * 1e-9
            if wanted and health.state is not wanted and stuck > settings.transition_limit:
                name = health.state.name if health.state else "an unknown state"
                self._stop_if(f"{health.name}: stays in {name} for {stuck:.3f} s instead of going to {wanted.name}")

    def _watch_commands(self) -> None:
        """Watch the age of the newest command; it counts from the tick in which the drives became enabled."""
        if self.goal is not Goal.ENABLED:
            return
        if not self.enabled:
            self._watch_fallen()
            return
        if not self._running:
            self._running = True
            self._command_tick = self._ticks
        age = self._ticks - self._command_tick
        if age >= self.settings.stop_age:
            self._stop_if(f"no command for {age} ticks (limit {self.settings.stop_age})")
        elif age >= self.settings.zero_age:
            self.counters["held"] += 1
            self._steer()

    def _watch_fallen(self) -> None:
        """Stop all drives when one fell back: it would be enabled again by itself on the way to the goal."""
        stopped = (State.FAULT, State.FAULT_REACTION_ACTIVE, State.QUICK_STOP_ACTIVE)
        for health in self.health:
            fallen = self._running and health.state is not State.OPERATION_ENABLED
            if health.state is not None and (fallen or health.state in stopped):
                self._stop_if(f"{health.name}: went to {health.state.name}")

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
        pack, base = _RPDO.pack, od.RPDO_BASE
        parts = []
        for axes in self._axes:
            frames = [pack(base + self._node_ids[i], 6, commands[i].value, velocity_counts[i]) for i in axes]
            parts.append(b"".join(frames))
        self._send(parts)

    def _send(self, parts: Sequence[bytes]) -> None:
        """Send on every channel; one that cannot take it stops the robot on the others too."""
        for channel, (link, part) in enumerate(zip(self._group.links, parts, strict=True)):
            try:
                link.send_frames(part)
            except LinkError as error:
                self.bus_conditions[channel] = BusCondition.OFF
                if self.stop.add(str(error), self._clock()):
                    self.goal = Goal.STOPPED
