"""The doors of a node: `subscribe`, `advertise`, `on_tick`, `on_readable`.

A node stays an ordinary `rclpy.node.Node` whose subscriptions and publishers come from the topic table; callbacks get
samples, not messages. Nodes of one process hear each other without the middleware (`composition`). With
`SHER3_EXECUTOR=default` the same calls make ordinary message-object subscriptions and publishers for rclpy's own
executor.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.node import Node
from sher3_description import ACTUATORS
from sher3_description.topics import Topic

from sher3_runtime.codec.cdr import CdrError, as_sent, codec
from sher3_runtime.codec.messages import from_message, message_class, to_message
from sher3_runtime.composed.composition import Composition
from sher3_runtime.composed.newest import newest_of_rings
from sher3_runtime.port import EXECUTOR_VARIABLE as EXECUTOR_VARIABLE
from sher3_runtime.port import GAPLESS, ONCE_A_TICK
from sher3_runtime.port import NODE_OPTIONS as NODE_OPTIONS
from sher3_runtime.port import PERIOD_VARIABLE as PERIOD_VARIABLE
from sher3_runtime.port import STATISTICS_VARIABLE as STATISTICS_VARIABLE
from sher3_runtime.port import TRACE_VARIABLE as TRACE_VARIABLE
from sher3_runtime.port import Ports as Ports
from sher3_runtime.port import Subscribed as Subscribed
from sher3_runtime.port import UnknownTopic as UnknownTopic
from sher3_runtime.port import clock_of as clock_of
from sher3_runtime.port import context_clock as context_clock
from sher3_runtime.port import find_topic as find_topic
from sher3_runtime.port import forget as forget
from sher3_runtime.port import ports as ports
from sher3_runtime.port import qos_profile as qos_profile
from sher3_runtime.port import raw_mode as raw_mode
from sher3_runtime.port import statistics_of as statistics_of
from sher3_runtime.port import use_clock as use_clock
from sher3_runtime.port import use_post as use_post
from sher3_runtime.tick import Tick
from sher3_runtime.timing import Histogram, Trace

Publish = Callable[[Any], None]


def subscribe(
    node: Node,
    name: str,
    callback: Callable[[Any], None],
    depth: int | None = None,
    refuse: Callable[[CdrError], None] | None = None,
) -> Subscribed:
    """Subscribe `node` to a topic of the table; `callback` gets one sample at a time, in order of arrival.

    Args:
        node: The subscribing node.
        name: Topic relative to `/sher3`.
        callback: Called with each sample; an exception in it ends the spinning.
        depth: Queue length instead of the table's; a recorder needs a longer one.
        refuse: Called with what is wrong with a message that does not fit the topic, as one with other joint names or
            another frame; by default the first one is logged and further ones are counted.

    Returns:
        The subscription; rclpy's own executor ignores its `wakes`.

    Raises:
        UnknownTopic: The name is not in the table.
    """
    topic, port = find_topic(name), ports(node)
    subscribed = Subscribed()
    receive = _receiver(port, topic, callback, subscribed)
    profile = qos_profile(topic.subscriber_qos)
    if depth is not None:
        profile.depth = depth
    raw = raw_mode()
    if port.composition is not None and port.turn is not None:
        # The subscription is made below; it is there when the composition asks to leave it.
        receive = port.composition.hear(
            topic, port.turn, receive, profile.depth, lambda: port.leave(node, name, subscription)
        )
    if raw:
        decode, garbage = port.decoder(topic), port.statistics.garbage

        def take(data: bytes) -> None:
            port.received[name] += 1
            try:
                sample = decode(data)
            except CdrError as error:
                if refuse is not None:
                    refuse(error)
                elif name not in garbage:
                    node.get_logger().warning(f"{name}: {error}; further ones are only counted")
                garbage[name] = garbage.get(name, 0) + 1
                return
            receive(sample)

        deliver = port.receiver(topic, take)
    else:

        def deliver(data: Any) -> None:
            port.received[name] += 1
            receive(from_message(topic, data))

    port.received[name] = 0
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
    port.open_box(name, subscription, deliver, profile.depth)
    return port.subscribed.setdefault(subscription.handle.pointer, subscribed)


def _receiver(
    port: Ports, topic: Topic, callback: Callable[[Any], None], subscribed: Subscribed
) -> Callable[[Any], None]:
    """Wrap a callback with the counting of age, gaps and duration."""
    name, clock, stats = topic.name, port.clock, port.statistics
    duration = stats.callback.setdefault(name, Histogram())
    if "String" in topic.type:
        return callback

    age, period = stats.age.setdefault(name, Histogram()), clock.period_ns
    gapless, last = name in GAPLESS, 0
    only = period if name in ONCE_A_TICK and not clock.stepped else 0
    handled = stats.trace(f"handled {name}")

    def receive(sample: Any) -> None:
        nonlocal last
        start, stamp = clock.now(), sample.stamp
        age.add(start - stamp)
        if gapless:
            if last and stamp - last > period:
                stats.dropped[name] = stats.dropped.get(name, 0) + (stamp - last) // period - 1
            last = stamp
        callback(sample)
        end = clock.now()
        duration.add(end - start)
        if handled is not None:
            handled.mark(stamp, end)
        subscribed.served = 0 <= end - stamp < only

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
    encode = codec(topic.type, topic.frame, ACTUATORS).encode
    raw, composition = raw_mode(), port.composition
    send = port.sender(topic, publisher) if raw else publisher.publish
    if composition is not None:
        return _publish_inside(port, topic, composition, encode, send, trace)

    def publish(sample: Any) -> None:
        sent[name] += 1
        if trace is not None:
            trace.mark(sample[0], now())
        send(encode(sample) if raw else to_message(topic, sample))

    if trace is None and raw and not port.clock.stepped:
        return lambda sample: send(encode(sample))
    return publish


def _publish_inside(
    port: Ports,
    topic: Topic,
    composition: Composition,
    encode: Callable[[Any], bytes],
    send: Callable[[bytes], None],
    trace: Trace | None,
) -> Publish:
    """Return `publish(sample)` for a node that shares its process."""
    name, now, sent = topic.name, port.clock.now, port.sent
    stepped, listeners = port.clock.stepped, port.listeners(name)

    def send_outside(data: bytes) -> None:
        sent[name] += 1
        send(data)

    # In stepped time all that is sent is counted, so nothing may be left out.
    listens = (lambda: 1) if stepped else listeners
    publish = composition.publisher(topic, as_sent(topic.type), encode, send_outside, listens, now)
    if trace is None:
        return publish

    def publish_traced(sample: Any) -> None:
        trace.mark(sample[0], now())
        publish(sample)

    return publish_traced


def latest(node: Node, name: str) -> Callable[[], Any]:
    """Return `take()` of a topic of the table: the newest sample since the last call, or None.

    For a node that looks at its own pace: no sample wakes it, and the queue holds one sample.

    Raises:
        UnknownTopic: The name is not in the table.
    """
    take = gathered(node, name, 1)

    def take_newest() -> Any:
        samples = take()
        return samples[-1] if samples else None

    return take_newest


def gathered(node: Node, name: str, depth: int) -> Callable[[], list[Any]]:
    """Return `take()` of a topic of the table: the samples since the last call, the oldest first.

    For a node that looks at its own pace: no sample wakes it. At most `depth` samples wait, the newest.

    Raises:
        UnknownTopic: The name is not in the table.
    """
    topic, port = find_topic(name), ports(node)
    if (composition := port.composition) is not None:
        # Half a period: nodes that look in the same tick ask once. A late tick and the next one may be nearer than
        # that, so for the sample of a tick, and in stepped time, whoever looks asks.
        pause = 0 if port.clock.stepped or name in ONCE_A_TICK else port.clock.period_ns // 2
        return composition.keep(topic, depth, lambda: _asks(node, topic, depth), pause)
    ask, _ = _asks(node, topic, depth)
    rings = newest_of_rings()
    if rings is None:
        return ask
    rank, decode = rings.look_at(name, depth), codec(topic.type, topic.frame, ACTUATORS).decode
    # A stream that comes by a ring may come by the middleware as well, later, where somebody else listens there.
    return lambda: _decoded(port, name, decode, rings.take(rank)) if rings.offers(rank) else ask()


def _asks(node: Node, topic: Topic, depth: int) -> tuple[Callable[[], list[Any]], Callable[[], None]]:
    """Subscribe for a node that nobody wakes; return what asks for the samples, and what ends the subscription."""
    port, name = ports(node), topic.name
    kind, profile = message_class(topic.type), qos_profile(topic.subscriber_qos)
    profile.depth = depth
    events = SubscriptionEventCallbacks(use_default_callbacks=False)
    subscription = node.create_subscription(
        kind, topic.full_name, lambda _: None, profile, raw=True, event_callbacks=events
    )
    port.subscriptions[name] = subscription
    port.polled.add(subscription.handle.pointer)
    port.open_box(name, subscription, None, depth)
    decode, take = port.decoder(topic), port.taker(subscription, kind)

    def ask() -> list[Any]:
        found: list[bytes] = []
        while len(found) < depth and (data := take()) is not None:
            found.append(data)
        return _decoded(port, name, decode, found) if found else []

    return ask, partial(port.leave, node, name, subscription)


def by_ring(node: Node, name: str, depth: int) -> Callable[[], list[Any]]:
    """Return `take()` of a topic that the node subscribes to: the samples since the last call that came by a ring.

    The middleware then brings only samples with a change that is to be heard at once (`topics.AT_ONCE`), and the node
    wakes up for each. Where there is no ring it brings all of them, and nothing comes here.
    """
    topic, port = find_topic(name), ports(node)
    rings = newest_of_rings() if port.composition is None else None
    if rings is None:
        return list
    port.subscribed[port.subscriptions[name].handle.pointer].urgent = True
    rank, decode = rings.look_at(name, depth), codec(topic.type, topic.frame, ACTUATORS).decode
    return lambda: _decoded(port, name, decode, rings.take(rank) if rings.offers(rank) else [])


def _decoded(port: Ports, name: str, decode: Callable[[bytes], Any], sent: list[bytes]) -> list[Any]:
    """Return the samples; bytes that are none are counted and left out."""
    samples, garbage = [], port.statistics.garbage
    for data in sent:
        try:
            samples.append(decode(data))
        except CdrError:
            garbage[name] = garbage.get(name, 0) + 1
    return samples


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

    def count(data: bytes) -> None:
        port.received[name] += 1
        callback(data)

    deliver = port.receiver(topic, count)
    events = SubscriptionEventCallbacks(use_default_callbacks=False)
    kind = message_class(topic.type)
    subscription = node.create_subscription(kind, topic.full_name, deliver, profile, raw=True, event_callbacks=events)
    port.subscriptions[name] = subscription
    port.open_box(name, subscription, deliver, profile.depth)


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
    send = port.sender(topic, publisher)

    def publish(data: bytes) -> None:
        port.sent[name] += 1
        send(data)

    return publish


def on_tick(node: Node, callback: Callable[[int], None], phase: float = 0.0, every: int = 1) -> Tick:
    """Call `callback(stamp_ns)` at every grid stamp plus `phase`.

    A tick that is so late that the next one is due is skipped and counted as a lost cycle; it is never made up for.

    Args:
        node: The node.
        callback: Gets the grid stamp `t_k` [ns], which is the same in every process.
        phase: Delay behind the stamp [s].
        every: Call only at stamps that are a multiple of `every` periods; in wall time, of nodes that share a process,
            at stamps some periods later, so that reports of a second do not all come in one period.

    Returns:
        The tick. A node whose tick only looks for late samples calls its `done(stamp)` when they were in time.
    """
    port = ports(node)
    offset = 0
    if every > 1 and port.composition is not None and not port.clock.stepped:
        offset = port.composition.offset(every)
    tick = Tick(callback, round(phase * 1e9), every, port.clock, port.statistics, port.turn, offset)
    port.ticks.append(tick)
    if node.executor is not None:
        node.executor.wake()
    return tick


def on_readable(node: Node, file: Any, callback: Callable[[], None]) -> None:
    """Call `callback()` whenever `file` (with `fileno()`) is readable.

    The callback must take all there is without blocking. A process with such a file waits on the file and looks at its
    topics at least once a period.
    """
    port = ports(node)
    port.readables.append((file, callback if port.turn is None else port.turn.guard(callback)))
    if node.executor is not None:
        node.executor.wake()
