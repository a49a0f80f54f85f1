"""The five mock drives on their channels, stepped by SYNC: the device end of the CAN links, driven by a plant.

At SYNC k the plant has integrated [t_k-1, t_k] with the demands received since SYNC k-1, and the drives report its
reading: nominal latency zero, echo(k) = command(k-1), as the recorded-run contract asks. While no SYNC comes the
plant goes on at its own period with the drives' stop ramps, so that a robot whose host died travels on as far as a
real one would.
"""

from __future__ import annotations

import struct
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import Protocol

from sher3_description import ACTUATORS, Robot

from .bus import CanLink, LinkGroup
from .drive_objects import SYNC_ID
from .frame import FRAME_SIZE
from .mock_drive import MockDrive
from .settings import MotorDriverSettings
from .units import AxisScale

_FRAME = struct.Struct("<IB3x8s")
_FREE_RUN_PERIODS = 5
_WATCH_NS = 1_000_000
_BATCHES = 64

FrameTamper = Callable[[int, bytes, int], bytes]


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
    def __init__(self, link: CanLink) -> None:
        self.link = link
        self.queue: deque[tuple[int, int, bytes]] = deque()
        self.drives: list[MockDrive] = []
        self.axes: list[int] = []
        self.by_node: dict[int, list[MockDrive]] = {}
        self.synced = False
        self.synced_at = 0
        self.live = True

    def receivers(self, can_id: int) -> list[MockDrive]:
        """Return the drives a frame may concern: the one whose node id it carries, or all for NMT and other nodes."""
        return self.by_node.get(can_id & 0x7F, self.drives)

    def sync_waits(self) -> bool:
        """Whether a further SYNC waits behind the one that is being answered."""
        return any(frame[0] == SYNC_ID for frame in self.queue)


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
        ticks: SYNCs the plant was stepped with.
        free_steps: steps it made without SYNC.
        tamper_frames: called with (channel, frames, now) on what the drives send; returns what goes on the wire.
        tamper_received: the same on what they are sent; called with b"" too, so that it can deliver later.
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
        self.tamper_frames: FrameTamper | None = None
        self.tamper_received: FrameTamper | None = None
        self._plant, self._clock, self._period = plant, clock, settings.period
        self._period_ns = round(settings.period * 1e9)
        self._stepped_at = clock()
        self._watch_at = 0
        self.links = tuple(links)
        self._group = LinkGroup(links)
        self._channels = [_Channel(link) for link in links]
        scales: dict[str, AxisScale] = {
            actuator.name: AxisScale.from_actuator(actuator) for actuator in robot.actuators
        }
        self._senders: list[Callable[[bytes], None]] = []
        by_name: dict[str, MockDrive] = {}
        for index, (channel, part) in enumerate(zip(self._channels, settings.channels, strict=True)):
            channel.axes = [ACTUATORS.index(name) for name in part.drives]
            self._senders.append(self._sender(index))
            for name in part.drives:
                drive = MockDrive(scales[name], 1 + ACTUATORS.index(name), self._senders[index])
                channel.drives.append(drive)
                channel.by_node[drive.node_id] = [drive]
                by_name[name] = drive
        self.drives = {name: by_name[name] for name in ACTUATORS}
        self._in_order = tuple(self.drives.values())

    @property
    def clock(self) -> Callable[[], int]:
        """The clock, in ns."""
        return self._clock

    def on_channel(self, channel: int) -> Sequence[MockDrive]:
        """Return the drives of a channel."""
        return self._channels[channel].drives

    def _sender(self, index: int) -> Callable[[bytes], None]:
        def send(frames: bytes) -> None:
            if self.tamper_frames is not None:
                frames = self.tamper_frames(index, frames, self._clock())
            if frames:
                self._channels[index].link.send_frames(frames)

        return send

    def serve(self, timeout: float) -> bool:
        """Wait at most `timeout` s for frames and handle the next batch of every channel; False when none came.

        SYNCs are answered, heartbeats and watchdogs kept going.
        """
        received = self._group.receive(timeout)
        if self._group.failures:
            raise next(iter(self._group.failures.values()))
        now = self._clock()
        if self.tamper_received is not None:
            by_channel = dict(received)
            channels = range(len(self._channels))
            received = [(i, self.tamper_received(i, by_channel.get(i, b""), now)) for i in channels]
        for index, frames in received:
            if len(frames) % FRAME_SIZE == 0:
                self._channels[index].queue.extend(_FRAME.iter_unpack(frames))
        while self._advance(now):
            self._step(now)
        self._keep_going(now)
        return any([frames for _, frames in received])

    def _keep_going(self, now: int) -> None:
        """Let the plant go on without SYNC, and heartbeats and watchdogs when they are due."""
        silent = now - self._stepped_at
        if self.ticks and silent >= _FREE_RUN_PERIODS * self._period_ns:
            for _ in range(min(silent // self._period_ns, 1000)):
                self._free_step(now)
            self._stepped_at = now
        if now >= self._watch_at:
            self._watch_at = now + _WATCH_NS
            for drive in self._in_order:
                drive.check_host(now)
                drive.node.poll(now)

    def poll(self) -> None:
        """Handle every frame that waits, as `serve` does."""
        for _ in range(_BATCHES):
            if not self.serve(0.0):
                return

    def _advance(self, now: int) -> bool:
        """Hand out frames up to the next SYNC of every channel; True when the plant is to step.

        A channel that misses a SYNC of the others holds them up for half a period once, then they go on without it.
        """
        for channel in self._channels:
            queue = channel.queue
            while queue and not channel.synced:
                can_id, length, data = queue.popleft()
                if can_id == SYNC_ID:
                    channel.synced = channel.live = True
                    channel.synced_at = now
                    break
                data = data[:length]
                for drive in channel.receivers(can_id):
                    drive.receive(can_id, data, now)
        synced = [channel for channel in self._channels if channel.synced]
        if not synced:
            return False
        missing = [channel for channel in self._channels if channel.live and not channel.synced]
        overdue = any(channel.sync_waits() or now - channel.synced_at > self._period_ns // 2 for channel in synced)
        if missing and not overdue:
            return False
        for channel in missing:
            channel.live = False
        return True

    def _step(self, now: int) -> None:
        """Step the plant and answer the SYNC on the channels that had it."""
        frames = self._plant_step()
        for index, channel in enumerate(self._channels):
            if channel.synced:
                channel.synced = False
                part = b"".join([frames[axis] for axis in channel.axes])
                if part:
                    self._senders[index](part)
        self.ticks += 1
        self._stepped_at = now

    def _free_step(self, now: int) -> None:
        for drive in self.drives.values():
            drive.check_host(now)
        self._plant_step()
        self.free_steps += 1

    def _plant_step(self) -> list[bytes]:
        """Step the plant with the drives' demands; return the TPDOs of every drive."""
        drives = self._in_order
        reading = self._plant.step([drive.demand(self._period) for drive in drives])
        columns = map(_floats, (reading.motor_position, reading.load_position, reading.demand, reading.effort))
        return [drive.sample(*axis) for drive, *axis in zip(drives, *columns, strict=True)]

    def close(self) -> None:
        """Leave every channel."""
        self._group.close()


def _floats(column: Sequence[float]) -> list[float]:
    """Return a column as Python floats, which round three times as fast as those of NumPy."""
    return column.tolist() if hasattr(column, "tolist") else list(column)
