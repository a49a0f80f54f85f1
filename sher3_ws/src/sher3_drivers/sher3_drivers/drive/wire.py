"""The frames between the driver and its drives: SYNC and heartbeat, RPDOs out, TPDOs in. It decides nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sher3_description import ACTUATORS

from sher3_drivers.bus.frame import bundle, pack_frame
from sher3_drivers.bus.group import LinkGroup
from sher3_drivers.bus.link import CanLink
from sher3_drivers.canopen.cia402 import Controlword
from sher3_drivers.canopen.objects import HEARTBEAT_BASE, NODE_IDS, OPERATIONAL, SYNC_ID
from sher3_drivers.canopen.protection import COUNTS, count_after
from sher3_drivers.canopen.rpdo import RpdoPacker
from sher3_drivers.canopen.tpdo import TpdoCollector
from sher3_drivers.errors import LinkError
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale

Failures = Sequence[tuple[int, LinkError]]
"""Channels that could not take their frames, each with its error."""


class DriveWire:
    """The CAN channels of the five drives.

    Attributes:
        collector: the TPDOs of the present tick, and those that came twice or with a wrong length.
    """

    def __init__(self, links: Sequence[CanLink], settings: MotorDriverSettings, scales: Sequence[AxisScale]) -> None:
        node_ids = [NODE_IDS[name] for name in ACTUATORS]
        axes = [[ACTUATORS.index(name) for name in channel.drives] for channel in settings.channels]
        where = [next(n for n, part in enumerate(settings.channels) if name in part.drives) for name in ACTUATORS]
        self.collector = TpdoCollector(scales, node_ids, settings.period, where, settings.protected)
        self._group = LinkGroup(links)
        self._rpdos = RpdoPacker(axes, node_ids, settings.protected)
        heartbeat = pack_frame(HEARTBEAT_BASE + settings.host_id, bytes([OPERATIONAL]))
        self._heartbeat = bundle([heartbeat] * len(links))
        counters = range(1, COUNTS + 1) if settings.protected else ()
        self._syncs = [bundle([pack_frame(SYNC_ID)] * len(links))]
        self._syncs += [bundle([pack_frame(SYNC_ID, bytes([counter]))] * len(links)) for counter in counters]
        self._heartbeat_ns = round(settings.host_heartbeat * 1e9)
        self._feedback_ns = round(settings.feedback_limit * settings.period * 1e9)
        self._heartbeat_at = self._synced_at = 0

    @property
    def links(self) -> Sequence[CanLink]:
        """One link per channel."""
        return self._group.links

    @property
    def dropped(self) -> int:
        """Frames the links could not deliver."""
        return sum(link.dropped for link in self._group.links)

    @property
    def waits(self) -> bool:
        """Whether there is something to wait on; not so on links within the process."""
        return self._group.waits

    @property
    def broken(self) -> Mapping[int, LinkError]:
        """Channels that can no longer be read, each with its error."""
        return self._group.failures

    def sync(self, now: int, audible: bool) -> Failures:
        """Begin a tick with SYNC, behind the host's heartbeat when that is due and the host is to be `audible`.

        The heartbeat has no timer of its own. When the loop that calls this hangs, it falls silent and the drives stop
        by themselves (CiA 301, consumer heartbeat time, object 0x1016).
        """
        counter = count_after(self.collector.counter) if len(self._syncs) > 1 else 0
        self.collector.begin(counter)
        frames = self._syncs[counter]
        if audible and now >= self._heartbeat_at:
            self._heartbeat_at = now + self._heartbeat_ns
            frames = self._heartbeat + frames
        self._synced_at = now
        return self._group.send(frames)

    def time_left(self, now: int) -> int:
        """Return how long the TPDOs of this tick may still be waited for, ns; negative when the time is over."""
        return self._synced_at + self._feedback_ns - now

    def receive(self, timeout: float = 0.0) -> list[tuple[int, int, bytes]] | None:
        """Take in what waits, waiting at most `timeout` s for it.

        Returns:
            The frames that are no TPDO as (channel, can_id, data), or None when no frame came.
        """
        frames = self._group.receive(timeout)
        return self.collector.take(frames) if frames else None

    def send(self, words: Sequence[Controlword], velocity_counts: Sequence[int]) -> Failures:
        """Send every drive its controlword and its target velocity in counts, both (5,)."""
        return self._group.send(self._rpdos.frames(words, velocity_counts, self.collector.counter))

    def ask(self, requests: bytes) -> Failures:
        """Send a bundle of SDO requests."""
        return self._group.send(requests)

    def close(self) -> None:
        """Leave the bus."""
        self._group.close()
