"""The five mock drives on their channels, stepped by SYNC: the device end of the CAN links, driven by a plant.

At SYNC k the plant integrates [t_k-1, t_k] with the demands received since SYNC k-1, and the drives report its reading.
So the nominal latency is zero and echo(k) = command(k-1), as the recorded-run contract asks. While no SYNC comes, the
plant goes on at its own period with the drives' stop ramps: a robot whose host died travels on as far as a real one.

Time alone says how many steps the plant makes. A process that was held up finds several SYNCs: it makes up for the time
and answers the newest, since nobody takes an older answer, and to give it would hold the next one up as well.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Protocol

from sher3_description import ACTUATORS, Robot

from sher3_drivers.bus.frame import BUNDLED, FRAME_SIZE, bundle, mark, unbundle
from sher3_drivers.bus.group import LinkGroup
from sher3_drivers.bus.link import CanLink
from sher3_drivers.canopen.objects import NODE_IDS, NODE_MASK, SYNC_ID
from sher3_drivers.mock.drive import MockDrive
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale

_FREE_RUN_PERIODS = 5
"""Periods without SYNC after which the plant goes on by itself; fewer are a host that is late."""
_MOST_FREE_STEPS = 1000
"""Periods made up for in one call at most: a process that was suspended for longer does not hang in the past."""
_MAKING_UP = 50_000_000
"""Time [ns] that one call may take to make up for periods: 250 of them on an idle computer. Where other work makes a
step as long as its period, the call would never end, and neither SYNC nor request for a fault be answered."""
_BATCHES = 64
"""Batches of frames taken in by one `serve` or `poll` at most."""

FrameTamper = Callable[[int, bytes, int], bytes]
Crossing = Callable[[str, Sequence[float]], Sequence[float]]
READINGS = ("motor_position", "load_position", "demand", "effort")
"""Columns of a plant's reading, as a drive samples them."""


class PlantReading(Protocol):
    """What the plant returns; sequences of five in the order of ACTUATORS, SI units."""

    @property
    def motor_position(self) -> Sequence[float]:
        """Motor encoder readings."""

    @property
    def load_position(self) -> Sequence[float]:
        """Load encoder readings."""

    @property
    def demand(self) -> Sequence[float]:
        """Demand the drives executed in the interval that ends now."""

    @property
    def effort(self) -> Sequence[float]:
        """Reported force or torque."""


class DrivePlant(Protocol):
    """What drives the mock drives."""

    def step(self, velocity_command: list[float]) -> PlantReading:
        """Integrate one control period with these velocity demands (5,) and return the reading at its end."""


class _Channel:
    """The drives of a channel, and how far they are in this tick.

    Attributes:
        synced: it has had the SYNC of this tick; frames behind it wait until the plant has made its step.
        synced_at: time of that SYNC, ns.
        live: it had a SYNC whenever the other channels had one.
        overtaken: another SYNC came before the one of this tick was answered.
    """

    def __init__(self, drives: Sequence[MockDrive]) -> None:
        self.drives = drives
        self.synced = False
        self.synced_at = 0
        self.live = True
        self.overtaken = False
        self._by_node = {drive.node_id: (drive,) for drive in drives}
        self._waiting: list[tuple[int, bytes]] = []

    def take(self, can_id: int, data: bytes, now: int) -> None:
        """Take a frame for the drive whose node id it carries, or, without one (NMT, other nodes), for all drives."""
        if can_id == SYNC_ID:
            overtaken = self.synced
            self.go_on(now)
            self.overtaken, self.synced, self.live = overtaken, True, True
            self.synced_at = now
            for drive in self.drives:
                drive.counter = data[0] if data else 0
        elif self.synced:
            self._waiting.append((can_id, data))
        else:
            for drive in self._by_node.get(can_id & NODE_MASK, self.drives):
                drive.receive(can_id, data, now)

    def go_on(self, now: int) -> None:
        """Take the frames that wait behind a SYNC which has been answered, or never will be."""
        self.synced = self.overtaken = False
        if self._waiting:
            waiting, self._waiting = self._waiting, []
            for can_id, data in waiting:
                self.take(can_id, data, now)


class MockDriveBus:
    """Five mock drives on the channels of `settings`.

    Args:
        links: one link per channel, in the order of the settings.
        plant: what they drive.
        robot: its scales.
        settings: channels and period.
        clock: time in ns, monotonic; stepped in tests.

    Attributes:
        links: the channels' links, to wait on.
        drives: the drives by actuator name.
        plant: what they drive.
        ticks: SYNCs the plant was stepped with.
        free_steps: steps it made without SYNC.
        step_end: time at which the present step of the plant ends, ns; steps that are made up for have their own.
        tamper_frames: called with (channel, frames, now) for frames the drives send; returns those that go on the wire.
        tamper_received: the same for frames they are sent; called with b"" too, so that it can deliver frames later.
        crossed: called with a column's name (`command` or one of `READINGS`) and its values (5,) between drives and
            plant; returns them as exchanged plugs leave them.
    """

    def __init__(
        self,
        links: Sequence[CanLink],
        plant: DrivePlant,
        robot: Robot,
        settings: MotorDriverSettings,
        clock: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self.ticks = 0
        self.free_steps = 0
        self.step_end = 0
        self.tamper_frames: FrameTamper | None = None
        self.tamper_received: FrameTamper | None = None
        self.crossed: Crossing | None = None
        self.plant, self._clock, self._period = plant, clock, settings.period
        self._period_ns = round(settings.period * 1e9)
        self._stepped_at, self._served_at = clock(), -1
        self.links = tuple(links)
        self._group = LinkGroup(links)
        scales: dict[str, AxisScale] = {
            actuator.name: AxisScale.from_actuator(actuator) for actuator in robot.actuators
        }
        by_name: dict[str, MockDrive] = {}
        for number, part in enumerate(settings.channels):
            for name in part.drives:
                node_id = NODE_IDS[name]
                by_name[name] = MockDrive(scales[name], node_id, partial(self._send_on, number), number)
        self.drives = {name: by_name[name] for name in ACTUATORS}
        self._in_order = tuple(self.drives.values())
        self._channels = [_Channel([by_name[name] for name in part.drives]) for part in settings.channels]

    @property
    def clock(self) -> Callable[[], int]:
        """The clock, in ns."""
        return self._clock

    def on_channel(self, channel: int) -> Sequence[MockDrive]:
        """Return the drives of a channel."""
        return self._channels[channel].drives

    def safe_torque_off(self, off: bool) -> None:
        """Open or close the line that takes the torque from all motors: the emergency stop's own circuit."""
        for drive in self._in_order:
            drive.take_torque(off)

    def _send_on(self, channel: int, frames: bytes) -> None:
        self._send(mark(frames, channel))

    def _send(self, frames: bytes) -> None:
        """Send a bundle; raise LinkError when a channel cannot take its frames."""
        if self.tamper_frames is not None:
            frames = self._tampered(self.tamper_frames, frames, False)
        if frames:
            for _, error in self._group.send(frames):
                raise error

    def _tampered(self, tamper: FrameTamper, frames: bytes, silence: bool) -> bytes:
        """Return a bundle as `tamper` leaves it, channel by channel; it sees silent channels when `silence` is set."""
        now, parts = self._clock(), unbundle(frames, len(self._channels))
        parts = [tamper(i, part, now) if part or silence else b"" for i, part in enumerate(parts)]
        return bundle([part if len(part) % FRAME_SIZE == 0 else b"" for part in parts])

    def serve(self, timeout: float) -> bool:
        """Wait at most `timeout` s for frames and handle all that wait; False when none came.

        The newest SYNC is answered, heartbeats and watchdogs kept going.
        """
        frames = self._receive(timeout)
        now = self._clock()
        if not frames and now == self._served_at and self.tamper_received is None:
            return False  # in stepped time: all that was due has been done
        self._served_at = now
        self._take(frames, now)
        if self._synced(now):
            if self._make_up_for(now) and (more := self._receive(0.0)):
                self._take(more, now)  # that took time: what came meanwhile goes first
            self._step(now)
        self._keep_going(now)
        return bool(frames)

    def _receive(self, timeout: float) -> bytes:
        """Return all that waits, as a bundle; wait at most `timeout` s for the first of it."""
        frames = self._group.receive(timeout)
        for _ in range(_BATCHES if frames and self._group.waits else 0):
            if not (more := self._group.receive(0.0)):
                break
            frames += more
        if self._group.failures:
            raise next(iter(self._group.failures.values()))
        return frames

    def _take(self, frames: bytes, now: int) -> None:
        """Give the frames of a bundle to the channels."""
        if self.tamper_received is not None:
            frames = self._tampered(self.tamper_received, frames, True)
        for can_id, length, number, data in BUNDLED.iter_unpack(frames):
            if number < len(self._channels):
                self._channels[number].take(can_id, data[:length], now)

    def _keep_going(self, now: int) -> None:
        """Let the plant go on without SYNC, and heartbeats and watchdogs when they are due."""
        silent = now - self._stepped_at
        if self.ticks and silent >= _FREE_RUN_PERIODS * self._period_ns:
            # The last period stays for the SYNC that may come at this very time.
            steps = min(silent // self._period_ns, _MOST_FREE_STEPS) - 1
            self._free_steps(now - steps * self._period_ns, steps, now)
        for drive in self._in_order:
            if now >= drive.due:
                drive.watch(now)

    def poll(self) -> None:
        """Handle every frame that waits, as `serve` does; what takes too long is left to the next call."""
        begin = self._clock()
        for _ in range(_BATCHES):
            if not self.serve(0.0) or self._clock() - begin > _MAKING_UP:
                return

    def _synced(self, now: int) -> bool:
        """Whether the plant is to make a step.

        A channel that misses a SYNC of the others holds them up once, for half a period. Then they go on without it.
        """
        synced = [channel for channel in self._channels if channel.synced]
        if len(synced) == len(self._channels) or not synced:
            return bool(synced)
        missing = [channel for channel in self._channels if channel.live and not channel.synced]
        overdue = any(channel.overtaken or now - channel.synced_at > self._period_ns // 2 for channel in synced)
        if missing and not overdue:
            return False
        for channel in missing:
            channel.live = False
        return True

    def _step(self, now: int) -> None:
        """Step the plant, answer the SYNC on the channels that had it, and take what waited behind it."""
        self.step_end = min([channel.synced_at for channel in self._channels if channel.synced])
        frames = self._plant_step()
        self._send(b"".join([frames[drive.node_id - 1] for c in self._channels if c.synced for drive in c.drives]))
        self.ticks += 1
        self._stepped_at += self._period_ns
        for channel in self._channels:
            channel.go_on(now)

    def _make_up_for(self, now: int) -> bool:
        """Make the steps of SYNCs that get no answer, if any: a drive goes on in time whether it is asked or not."""
        if not self.ticks or abs(now - self._stepped_at) > 1000 * self._period_ns:
            self._stepped_at = now - self._period_ns
        late = round((now - self._stepped_at) / self._period_ns) - 1
        self._free_steps(self._stepped_at + self._period_ns, late, now)
        return late > 0

    def _free_steps(self, first: int, count: int, now: int) -> None:
        """Make steps without SYNC, of which the first ends at `first` [ns]; leave out what would take too long."""
        for end in range(first, first + count * self._period_ns, self._period_ns):
            for drive in self._in_order:
                drive.check_host(now)
            self.step_end = self._stepped_at = end
            self._plant_step()
            self.free_steps += 1
            if self._clock() - now > _MAKING_UP:
                self._stepped_at = first + (count - 1) * self._period_ns
                return

    def _plant_step(self) -> list[bytes]:
        """Step the plant with the drives' demands; return the TPDOs of every drive."""
        drives, crossed = self._in_order, self.crossed
        command = [drive.demand(self._period) for drive in drives]
        reading = self.plant.step(command if crossed is None else list(crossed("command", command)))
        columns = list(map(_floats, (reading.motor_position, reading.load_position, reading.demand, reading.effort)))
        if crossed is not None:
            columns = [list(crossed(name, values)) for name, values in zip(READINGS, columns, strict=True)]
        return [drive.sample(*axis) for drive, *axis in zip(drives, *columns, strict=True)]

    def close(self) -> None:
        """Leave every channel."""
        self._group.close()


def _floats(column: Sequence[float]) -> list[float]:
    """Return a column as Python floats, which round three times as fast as those of NumPy."""
    return column.tolist() if hasattr(column, "tolist") else list(column)
