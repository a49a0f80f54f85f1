"""The doors of a node: `subscribe`, `advertise`, `on_tick`, `on_readable`.

A node stays an ordinary `rclpy.node.Node` whose subscriptions and publishers come from the topic table; callbacks get
samples, not messages. With `SHER3_EXECUTOR=default` the same calls make ordinary message-object subscriptions and
publishers for rclpy's own executor.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any
from weakref import WeakKeyDictionary

from rclpy.context import Context
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.utilities import get_default_context
from sher3_common import Sher3Error
from sher3_description import ACTUATORS
from sher3_description.topics import NAMESPACE, TOPICS, Qos, Topic

from sher3_runtime.clock import Clock
from sher3_runtime.codec.cdr import CdrError, codec
from sher3_runtime.codec.messages import from_message, message_class, to_message
from sher3_runtime.tick import Tick
from sher3_runtime.timing import Histogram, Statistics

EXECUTOR_VARIABLE = "SHER3_EXECUTOR"
PERIOD_VARIABLE = "SHER3_CONTROL_PERIOD"
TRACE_VARIABLE = "SHER3_TRACE"
STATISTICS_VARIABLE = "SHER3_STATISTICS"

NODE_OPTIONS: dict[str, Any] = {
    "namespace": NAMESPACE,
    "enable_rosout": False,
    "start_parameter_services": False,
    "use_global_arguments": False,
    "parameter_overrides": [Parameter("start_type_description_service", value=False)],
}
"""Keyword arguments for `Node.__init__`: no parameter and type services and no rosout, which would cost a fifth of the
loop."""

GAPLESS = frozenset(
    {"servo_jv", "drives/setpoint_jv", "drives/measured_js", "measured_js", "force/measured_cf", "pedal/measured"}
)
"""Streams with a sample at every tick: a stamp that skips a tick means a lost sample."""

Publish = Callable[[Any], None]


class Subscribed:
    """A subscription of a node.

    Attributes:
        wakes: Whether a sample wakes the process. A node that has nothing to do before some other sample comes sets
            this to False, and gets the sample, in the order of its subscriptions, once something else has woken the
            process.
    """

    __slots__ = ("wakes",)

    def __init__(self) -> None:
        self.wakes = True


_clocks: WeakKeyDictionary[Context, Clock] = WeakKeyDictionary()


class UnknownTopic(Sher3Error):
    """A topic name that is not in the topic table."""


def use_clock(context: Context, clock: Clock) -> None:
    """Make `clock` the time of every node of `context` created from now on."""
    _clocks[context] = clock


def clock_of(node: Node) -> Clock:
    """Return the clock of the node's context; by default the wall clock of period `SHER3_CONTROL_PERIOD` [s]."""
    return context_clock(node.context)


def context_clock(context: Context | None = None) -> Clock:
    """Return the clock of a context, by default that of the process's own context.

    For devices that are made before their node.
    """
    context = context or get_default_context()
    if context not in _clocks:
        _clocks[context] = Clock(round(float(os.environ.get(PERIOD_VARIABLE, "0.002")) * 1e9))
    return _clocks[context]


class Ports:
    """What the executor needs to know of one node."""

    def __init__(self, node: Node) -> None:
        self.name = node.get_name()
        self.clock = clock_of(node)
        self.statistics = Statistics()
        self.statistics.traces = {} if os.environ.get(TRACE_VARIABLE) else None
        self.polled: set[int] = set()
        self.deliveries: dict[int, Callable[[bytes], None]] = {}
        self.subscribed: dict[int, Subscribed] = {}
        self.ticks: list[Tick] = []
        self.readables: list[tuple[Any, Callable[[], None]]] = []
        self.publishers: dict[str, Any] = {}
        self.subscriptions: dict[str, Any] = {}
        self.sent: dict[str, int] = {}
        self.received: dict[str, int] = {}


def ports(node: Node) -> Ports:
    """Return the ports of a node, made at the first call."""
    try:
        return node.__dict__["_sher3_ports"]
    except KeyError:
        return node.__dict__.setdefault("_sher3_ports", Ports(node))


def statistics_of(node: Node) -> Statistics:
    """Return the timing statistics of a node."""
    return ports(node).statistics


def qos_profile(qos: Qos) -> QoSProfile:
    """Return the rclpy profile of a topic's quality of service."""
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=qos.depth,
        reliability=ReliabilityPolicy[qos.reliability.upper()],
        durability=DurabilityPolicy[qos.durability.upper()],
    )


def find_topic(name: str) -> Topic:
    """Return the row of the topic table.

    Raises:
        UnknownTopic: no such row.
    """
    try:
        return TOPICS[name]
    except KeyError:
        raise UnknownTopic("topic", value=name, limit=", ".join(TOPICS), remedy="use a name of the table") from None


def raw_mode() -> bool:
    """Return whether topics are handled as raw bytes (the default) or as message objects."""
    return os.environ.get(EXECUTOR_VARIABLE, "") != "default"


def subscribe(node: Node, name: str, callback: Callable[[Any], None], depth: int | None = None) -> Subscribed:
    """Subscribe `node` to a topic of the table; `callback` gets one sample at a time, in order of arrival.

    Args:
        node: The subscribing node.
        name: Topic relative to `/sher3`.
        callback: Called with each sample; an exception in it ends the spinning.
        depth: Queue length instead of the table's; a recorder needs a longer one.

    Returns:
        The subscription; rclpy's own executor ignores its `wakes`.

    Raises:
        UnknownTopic: The name is not in the table.
    """
    topic, port = find_topic(name), ports(node)
    receive = _receiver(port, topic, callback)
    profile = qos_profile(topic.subscriber_qos)
    if depth is not None:
        profile.depth = depth
    raw = raw_mode()
    if raw:
        decode, garbage = codec(topic.type, topic.frame_id, ACTUATORS).decode, port.statistics.garbage

        def deliver(data: Any) -> None:
            try:
                sample = decode(data)
            except CdrError as error:
                port.received[name] = port.received.get(name, 0) + 1
                if name not in garbage:
                    node.get_logger().warning(f"{name}: {error}; further ones are only counted")
                garbage[name] = garbage.get(name, 0) + 1
                return
            receive(sample)
    else:

        def deliver(data: Any) -> None:
            receive(from_message(topic, data))

    subscription = node.create_subscription(
        message_class(topic.type),
        topic.full_name,
        deliver,
        profile,
        raw=raw,
        event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
    )
    port.subscriptions[name] = subscription
    port.deliveries[subscription.handle.pointer] = deliver
    return port.subscribed.setdefault(subscription.handle.pointer, Subscribed())


def _receiver(port: Ports, topic: Topic, callback: Callable[[Any], None]) -> Callable[[Any], None]:
    """Wrap a callback with the counting of age, gaps and duration."""
    name, clock, stats = topic.name, port.clock, port.statistics
    received = port.received
    received[name] = 0
    duration = stats.callback.setdefault(name, Histogram())
    if "String" in topic.type:

        def receive_text(sample: Any) -> None:
            received[name] += 1
            callback(sample)

        return receive_text

    age, period = stats.age.setdefault(name, Histogram()), clock.period_ns
    gapless, last = name in GAPLESS, 0
    arrived, handled = stats.trace(f"receive {name}"), stats.trace(f"handled {name}")

    def receive(sample: Any) -> None:
        nonlocal last
        received[name] += 1
        start, stamp = clock.now(), sample.stamp
        age.add(start - stamp)
        if gapless:
            if last and stamp - last > period:
                stats.dropped[name] = stats.dropped.get(name, 0) + (stamp - last) // period - 1
            last = stamp
        callback(sample)
        end = clock.now()
        duration.add(end - start)
        if arrived is not None and handled is not None:
            arrived.mark(stamp, start)
            handled.mark(stamp, end)

    return receive


def advertise(node: Node, name: str) -> Publish:
    """Return `publish(sample)` of a topic of the table.

    Raises:
        UnknownTopic: the name is not in the table; `publish` raises CdrError for a sample that does not fit the type.
    """
    topic, port = find_topic(name), ports(node)
    publisher = node.create_publisher(
        message_class(topic.type),
        topic.full_name,
        qos_profile(topic.qos),
        event_callbacks=PublisherEventCallbacks(use_default_callbacks=False),
    )
    port.publishers[name] = publisher
    stamped = not topic.type.endswith("/String")
    trace = port.statistics.trace(f"publish {name}") if stamped else None
    sent, now = port.sent, port.clock.now
    sent[name] = 0
    encode, raw = codec(topic.type, topic.frame_id, ACTUATORS).encode, raw_mode()
    # The handle's own method: rclpy's wrapper would enter the handle's context at each call.
    send = publisher.handle.publish_raw if raw else publisher.publish

    def publish(sample: Any) -> None:
        sent[name] += 1
        if trace is not None:
            trace.mark(sample[0], now())
        send(encode(sample) if raw else to_message(topic, sample))

    if trace is None and raw and not port.clock.stepped:
        return lambda sample: send(encode(sample))
    return publish


def latest(node: Node, name: str) -> Callable[[], Any]:
    """Return `take()` of a topic of the table: the newest sample since the last call, or None.

    For a node that looks at its own pace: no sample wakes it, and the queue holds one sample.

    Raises:
        UnknownTopic: The name is not in the table.
    """
    topic, port = find_topic(name), ports(node)
    kind, profile = message_class(topic.type), qos_profile(topic.subscriber_qos)
    profile.depth = 1
    events = SubscriptionEventCallbacks(use_default_callbacks=False)
    subscription = node.create_subscription(
        kind, topic.full_name, lambda _: None, profile, raw=True, event_callbacks=events
    )
    port.subscriptions[name] = subscription
    port.polled.add(subscription.handle.pointer)
    decode, take = codec(topic.type, topic.frame_id, ACTUATORS).decode, subscription.handle.take_message
    garbage = port.statistics.garbage

    def take_newest() -> Any:
        if (taken := take(kind, True)) is None:
            return None
        try:
            return decode(taken[0])
        except CdrError:
            garbage[name] = garbage.get(name, 0) + 1
            return None

    return take_newest


def subscribe_raw(node: Node, name: str, callback: Callable[[bytes], None], depth: int | None = None) -> None:
    """Subscribe to a topic of the table as raw CDR bytes: what a recorder needs.

    Raises:
        UnknownTopic: the name is not in the table.
    """
    topic, port = find_topic(name), ports(node)
    profile = qos_profile(topic.qos)
    if depth is not None:
        profile.depth = depth
    port.received[name] = 0

    def deliver(data: bytes) -> None:
        port.received[name] += 1
        callback(data)

    events = SubscriptionEventCallbacks(use_default_callbacks=False)
    kind = message_class(topic.type)
    subscription = node.create_subscription(kind, topic.full_name, deliver, profile, raw=True, event_callbacks=events)
    port.subscriptions[name] = subscription


def advertise_raw(node: Node, name: str, depth: int | None = None) -> Callable[[bytes], None]:
    """Return `publish(data)` of a topic of the table for CDR bytes: what a replay needs.

    Args:
        node: the node.
        name: topic of the table.
        depth: queue length instead of the table's (a replay sends in bursts).

    Raises:
        UnknownTopic: the name is not in the table.
    """
    topic, port = find_topic(name), ports(node)
    events = PublisherEventCallbacks(use_default_callbacks=False)
    kind, profile = message_class(topic.type), qos_profile(topic.qos)
    if depth is not None:
        profile.depth = depth
    publisher = node.create_publisher(kind, topic.full_name, profile, event_callbacks=events)
    port.publishers[name] = publisher
    port.sent[name] = 0

    def publish(data: bytes) -> None:
        port.sent[name] += 1
        publisher.handle.publish_raw(data)

    return publish


def on_tick(node: Node, callback: Callable[[int], None], phase: float = 0.0, every: int = 1) -> Tick:
    """Call `callback(stamp_ns)` at every grid stamp plus `phase`.

    A tick that is so late that the next one is due is skipped and counted as a lost cycle; it is never made up for.

    Args:
        node: The node.
        callback: Gets the grid stamp `t_k` [ns], which is the same in every process.
        phase: Delay behind the stamp [s].
        every: Call only at stamps that are a multiple of `every` periods.

    Returns:
        The tick. A node whose tick only looks for late samples calls its `done(stamp)` when they were in time.
    """
    port = ports(node)
    tick = Tick(callback, round(phase * 1e9), every, port.clock, port.statistics)
    port.ticks.append(tick)
    if node.executor is not None:
        node.executor.wake()
    return tick


def on_readable(node: Node, file: Any, callback: Callable[[], None]) -> None:
    """Call `callback()` whenever `file` (with `fileno()`) is readable.

    The callback must take all there is without blocking. A process with such a file waits on the file and looks at its
    topics at least once a period.
    """
    ports(node).readables.append((file, callback))
    if node.executor is not None:
        node.executor.wake()
