"""Record the graph: raw bytes of every topic of the table into a new bag.

When the disk refuses the recording, `/diagnostics` says so. A node whose recording is required then ends, which stops
the robot. Otherwise the node stays, counts the samples it does not record, and the robot goes on.

In stepped time samples are taken as they come, so that all of them are recorded when a step ends.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from operator import itemgetter
from pathlib import Path
from typing import Any

import rclpy
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.subscription import Subscription
from sher3_common.samples import DiagnosticSample
from sher3_common.stamps import nanoseconds
from sher3_description import TOPICS, Robot, load_robot
from sher3_runtime import advertise, environment
from sher3_runtime.codec.messages import message_class
from sher3_runtime.composed.ring import shared_rings
from sher3_runtime.execution.spinning import spin
from sher3_runtime.ports import NODE_OPTIONS, clock_of, find_topic, on_tick, ports, qos_profile, subscribe_raw
from sher3_runtime.process import stop_on_signals

from sher3_bags.errors import BagError
from sher3_bags.recording.beside import Beside
from sher3_bags.recording.recorder import Recorder
from sher3_bags.run import RunMetadata

POLL_NS = 40_000_000
"""Time between two looks [ns]: the more come at once, the less each costs; ring and queues hold seconds."""
REPORT_NS = 1_000_000_000
FOUND = 5.0
"""Time [s] in which a busy computer finds the topics of a robot: a quiet one takes less than 0.5 s."""
OK, ERROR = 0, 2

DEPTH = 5000
"""Samples that may wait while a chunk is compressed, or disk or processor are busy: ten seconds of a 500 Hz stream.
Fast DDS holds no more of a topic unless told in a file of its own."""


def overflow(wait: int, period: int) -> str | None:
    """Return a sentence on samples that were lost because the recorder looked too late; None when its queues sufficed.

    Args:
        wait: longest time between two looks [ns].
        period: of the fastest streams [ns].
    """
    held = DEPTH * period
    if wait <= held:
        return None
    return (
        f"the recorder was held up for {wait * 1e-9:.1f} s, and its queues hold {held * 1e-9:.1f} s: samples of every "
        "topic are lost; this computer has too much else to do"
    )


Heard = tuple[int, str, bytes, int]
"""Arrival [ns], topic, data and time of sending [ns] of a sample."""


class Ears(Node):
    """The subscriptions of the recorder: a node that no executor waits on, emptied by `listen`.

    Waking up for each of thousands of samples a second would cost the recorder five times the work of writing them. The
    middleware notes when a sample arrived, so looking later loses nothing. What a process of several nodes says is read
    from its ring instead (`sher3_runtime.composed.ring`), so that it need not send it.
    """

    def __init__(self, owner: Node, names: Iterable[str], **options: Any) -> None:
        super().__init__(f"{owner.get_name()}_ears", **{**NODE_OPTIONS, **options})
        self._now = clock_of(owner).now
        self._owner, self._streams = ports(owner), dict[str, Subscription]()
        for name in names:
            topic, kind = find_topic(name), message_class(find_topic(name).type)
            profile = qos_profile(topic.qos)
            profile.depth = DEPTH
            events = SubscriptionEventCallbacks(use_default_callbacks=False)
            subscription = self.create_subscription(
                kind, topic.full_name, _never, profile, raw=True, event_callbacks=events
            )
            # The start barrier counts the owner's subscriptions.
            self._owner.subscriptions[name] = self._streams[name] = subscription
            self._owner.received[name] = 0
        self._rings = [ring.join() for ring in shared_rings()]
        self._by_ring: dict[int, str] | None = None

    def listen(self) -> list[Heard]:
        """Return all samples since the last call, by arrival."""
        shift, received = self._shift(), self._owner.received
        samples = self._read_rings()
        for name, stream in self._streams.items():
            take, kind = stream.handle.take_message, stream.msg_type
            while (taken := take(kind, True)) is not None:
                data, info = taken
                samples.append((info["received_timestamp"] + shift, name, data, info["source_timestamp"] + shift))
                received[name] += 1
        samples.sort(key=itemgetter(0))
        return samples

    def _read_rings(self) -> list[Heard]:
        """Return what has come by ring; the first call, when all have met, takes those streams off the middleware."""
        names = self._leave_streams() if self._by_ring is None else self._by_ring
        return [
            (sent, names[rank], data, sent) for ring in self._rings for rank, sent, data in ring.read() if rank in names
        ]

    def _leave_streams(self) -> dict[int, str]:
        offered = set[int]().union(*[reader.ring.offered for reader in self._rings])
        names = self._by_ring = {
            rank: name for rank, name in enumerate(TOPICS) if rank in offered and name in self._streams
        }
        for name in names.values():
            self.destroy_subscription(self._streams.pop(name))
            del self._owner.subscriptions[name]
        return names

    def _shift(self) -> int:
        """Return the clock of the graph minus the system time, with which the middleware stamps [ns].

        Of several readings the one taken in the shortest time counts: a process that is held up between the two clocks
        would misplace a whole batch of samples.
        """
        readings = ((self._now(), time.time_ns(), self._now()) for _ in range(3))
        _, shift = min((after - before, (before + after) // 2 - system) for before, system, after in readings)
        return shift


def _never(_: bytes) -> None:
    raise AssertionError("no executor runs this node")


class RecorderNode(Node):
    """Records `topics` (by default all) into the new folder `output`; `close` completes the bag and reports losses.

    Attributes:
        recorder: The plain recorder that writes the bag.
        counts: Counts per topic, set by `close`.
        failure: Why the bag takes no more samples; None while it does.
        unrecorded: Number of samples that came after the failure.
    """

    def __init__(
        self,
        output: Path | str,
        robot: Robot | None = None,
        *,
        topics: Iterable[str] | None = None,
        metadata: RunMetadata | None = None,
        parameters: dict[str, Any] | None = None,
        required: bool = True,
        **options: Any,
    ) -> None:
        """Take the new folder, robot, topics and metadata; a `required` recording that fails ends the node."""
        super().__init__("recorder", **{**NODE_OPTIONS, **options})
        robot = robot or load_robot()
        self.recorder = Recorder(Path(output), robot, metadata, parameters, Beside(robot))
        self.counts: dict[str, dict[str, int]] = {}
        self.failure: BagError | None = None
        self.unrecorded = 0
        self._required = required
        self._begun = self._looked = clock_of(self).now()
        self._first: int | None = None
        self._longest_wait = 0
        self._ears: Ears | None = None
        self._publish_report = advertise(self, "diagnostics")
        names = tuple(TOPICS if topics is None else topics)
        if clock_of(self).stepped:
            for name in names:
                subscribe_raw(self, name, self._receiver(name), depth=DEPTH)
        else:
            self._ears = Ears(self, names, **options)
            on_tick(self, self._poll, every=max(1, round(POLL_NS / clock_of(self).period_ns)))
        # In the quieter half of the period.
        period = clock_of(self).period_ns
        on_tick(self, self._report, phase=0.7e-9 * period, every=max(1, round(REPORT_NS / period)))

    def _receiver(self, name: str) -> Callable[[bytes], None]:
        now = clock_of(self).now

        def receive(data: bytes) -> None:
            self._write(name, data, now())

        return receive

    def _poll(self, _: int) -> None:
        if self._ears is not None and not self.recorder.closed:
            before, self._looked = self._looked, clock_of(self).now()
            self._longest_wait = max(self._longest_wait, self._looked - before)
            for arrived, name, data, sent in self._ears.listen():
                self._write(name, data, arrived, sent)

    def _write(self, name: str, data: bytes, arrived: int, sent: int | None = None) -> None:
        if self.failure is not None:
            self.unrecorded += 1
        elif not self.recorder.closed:
            try:
                self.recorder.write(name, data, arrived, sent)
            except BagError as error:
                self._fail(error)
            if self._first is None and name != "diagnostics":  # those are the recorder's own
                self._first = arrived

    def lasts(self, seconds: float) -> bool:
        """Return whether it goes on: for `seconds` from the robot's first sample, or until none came in `FOUND`."""
        if self._first is None:
            return clock_of(self).now() < self._begun + nanoseconds(max(seconds, FOUND))
        return clock_of(self).now() < self._first + nanoseconds(seconds)

    def _fail(self, error: BagError) -> None:
        """Say that the recording has ended; end the node if the recording is required."""
        self.failure = error
        self.unrecorded += 1
        self._report(clock_of(self).now())
        if self._required:
            raise error
        self.get_logger().error(f"{error}; the robot goes on without a recording")

    def _report(self, stamp: int) -> None:
        values = (
            ("messages", str(sum(entry["messages"] for entry in self.recorder.counts().values()))),
            ("unrecorded", str(self.unrecorded)),
            ("required", str(self._required)),
        )
        level, message = (OK, "recording") if self.failure is None else (ERROR, f"not recording: {self.failure}")
        self._publish_report(DiagnosticSample(stamp, "recorder: bag", level, message, values))

    def close(self) -> None:
        """Complete the bag; say what is in it and what was missed."""
        if self.recorder.closed:
            return
        try:
            self._poll(0)
            self.counts = self.recorder.close() if self.failure is None else self.recorder.counts()
        finally:
            if self._ears is not None:
                self._ears.destroy_node()
        total = sum(entry["messages"] for entry in self.counts.values())
        self.get_logger().info(f"recorded {total} messages of {len(self.counts)} topics in {self.recorder.folder}")
        for topic, entry in self.counts.items():
            if entry["dropped"] or entry["disordered"]:
                self.get_logger().warning(
                    f"{topic}: {entry['dropped']} samples missing, {entry['disordered']} out of order"
                )
        if lost := overflow(self._longest_wait, clock_of(self).period_ns):
            self.get_logger().warning(lost)


def run(
    output: Path,
    robot: Robot | None = None,
    *,
    topics: Iterable[str] | None = None,
    seconds: float | None = None,
    domain: int | None = None,
) -> dict[str, dict[str, int]]:
    """Record in a process of its own until a signal or for `seconds` (`lasts`); return the counts per topic.

    `domain`: ROS domain id; that of the environment by default.

    Raises:
        BagError: the output exists.
    """
    environment.apply(domain)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        stop = stop_on_signals()
        node = RecorderNode(output, robot, topics=topics)
        spin([node], stop=lambda: stop() or not (seconds is None or node.lasts(seconds)), diagnostics=False)
        return node.counts
    finally:
        rclpy.try_shutdown()
