"""What the runtime knows of one node: its clock, its statistics, its ends of topics; and how topics become ROS."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable
from typing import Any
from weakref import WeakKeyDictionary

from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.utilities import get_default_context
from sher3_common import Sher3Error
from sher3_common.namespace import graph_namespace
from sher3_description import ACTUATORS
from sher3_description.topics import TOPICS, Qos, Topic

from sher3_runtime.clock import Clock
from sher3_runtime.codec.cdr import codec
from sher3_runtime.composed.composition import Composition, composing
from sher3_runtime.composed.turn import Turn
from sher3_runtime.post import Box, Post
from sher3_runtime.tick import Tick
from sher3_runtime.timing import Statistics

EXECUTOR_VARIABLE = "SHER3_EXECUTOR"
PERIOD_VARIABLE = "SHER3_CONTROL_PERIOD"
TRACE_VARIABLE = "SHER3_TRACE"
STATISTICS_VARIABLE = "SHER3_STATISTICS"

NODE_OPTIONS: dict[str, Any] = {
    "namespace": graph_namespace(),
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
ONCE_A_TICK = GAPLESS | {"servo_cv"}
"""Streams with at most one sample for each tick, whose stamp it bears."""
REMEMBERED = 8
"""Samples of a latched topic that stepped time remembers: more than any node sends in a tick."""


class Subscribed:
    """A subscription of a node.

    Attributes:
        wakes: Whether a sample wakes the process. A node that has nothing to do before some other sample comes sets
            this to False, and gets the sample, in the order of its subscriptions, once something else has woken the
            process.
        urgent: Whether a sample wakes the process though the topic was silent, see `topics.AT_ONCE`.
        served: Whether the newest sample was that of the present tick, so that the next one has still to come.
    """

    __slots__ = ("served", "urgent", "wakes")

    def __init__(self) -> None:
        self.wakes, self.urgent, self.served = True, False, False


_clocks: WeakKeyDictionary[Context, Clock] = WeakKeyDictionary()
_posts: WeakKeyDictionary[Context, Post] = WeakKeyDictionary()


class UnknownTopic(Sher3Error):
    """A topic name that is not in the topic table."""


def use_clock(context: Context, clock: Clock) -> None:
    """Make `clock` the time of every node of `context` created from now on."""
    _clocks[context] = clock


def use_post(context: Context, post: Post) -> None:
    """Let every node of `context` created from now on send and receive by `post`; `SHER3_EXECUTOR=default` does not."""
    _posts[context] = post


def forget(context: Context) -> None:
    """Forget clock and post of a context that has ended: a post holds its nodes, and each of them the context."""
    _clocks.pop(context, None)
    _posts.pop(context, None)


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
    """What the executor needs to know of one node.

    Attributes:
        composition: The nodes that share the process with this one; None for a node alone.
        turn: Then, the right to run this node's code.
        post: What carries its samples instead of the middleware; None without one.
        boxes: Its queues there, by the pointers of its subscriptions.
        sent: In stepped time, how many samples it sent to the middleware, by topic; `received`: how many came from it.
        last_sent: In stepped time, the newest `REMEMBERED` samples of each latched topic; `last_received`: the same.
    """

    def __init__(self, node: Node) -> None:
        self.composition: Composition | None = composing() if raw_mode() else None
        self.turn: Turn | None = None if self.composition is None else self.composition.turn()
        self.post = _posts.get(node.context) if raw_mode() else None
        self.boxes: dict[int, Box] = {}
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
        self.last_sent: dict[str, deque[bytes]] = {}
        self.last_received: dict[str, deque[bytes]] = {}

    def leave(self, node: Node, name: str, subscription: Any) -> None:
        """Take a subscription off the middleware: its samples come from within the process."""
        pointer = subscription.handle.pointer
        if self.post is not None and (box := self.boxes.pop(pointer, None)) is not None:
            self.post.leave(name, box)
        self.polled.discard(pointer)
        self.deliveries.pop(pointer, None)
        self.subscribed.pop(pointer, None)
        self.subscriptions.pop(name, None)
        self.received.pop(name, None)
        self.last_received.pop(name, None)
        node.destroy_subscription(subscription)

    def open_box(self, name: str, subscription: Any, deliver: Callable[[bytes], None] | None, depth: int) -> None:
        """Let the samples of a subscription come by the post, where there is one."""
        if self.post is not None:
            self.boxes[subscription.handle.pointer] = self.post.box(name, depth, deliver)

    def taker(self, subscription: Any, kind: Any) -> Callable[[], bytes | None]:
        """Return what takes the bytes of a sample that waits, or None."""
        if (box := self.boxes.get(subscription.handle.pointer)) is not None:
            return box.take
        take = subscription.handle.take_message

        def take_bytes() -> bytes | None:
            taken = take(kind, True)
            return None if taken is None else taken[0]

        return take_bytes

    def sender(self, topic: Topic, publisher: Any) -> Callable[[bytes], None]:
        """Return what sends bytes: by the post, or by the middleware."""
        if self.post is not None:
            return self.post.sender(topic.name, topic.qos.durability == "transient_local")
        # The handle's own method: rclpy's wrapper would enter the handle's context at each call.
        return self._remembering(topic, self.last_sent, publisher.handle.publish_raw)

    def receiver(self, topic: Topic, deliver: Callable[[bytes], None]) -> Callable[[bytes], None]:
        """Return what takes the bytes that the middleware brings."""
        return self._remembering(topic, self.last_received, deliver)

    def _remembering(
        self, topic: Topic, last: dict[str, deque[bytes]], go_on: Callable[[bytes], None]
    ) -> Callable[[bytes], None]:
        """Return `go_on`; where stepped time has to know which latched sample was the last, one that notes it first."""
        if self.post is not None or not self.clock.stepped or topic.qos.durability != "transient_local":
            return go_on
        newest = last[topic.name] = deque[bytes](maxlen=REMEMBERED)

        def remember(data: bytes) -> None:
            newest.append(data)
            go_on(data)

        return remember

    def decoder(self, topic: Topic) -> Callable[[bytes], Any]:
        """Return what makes samples of the bytes of a topic."""
        decode = codec(topic.type, topic.frame, ACTUATORS).decode
        return decode if self.post is None else self.post.decoder(topic.name, decode)

    def listeners(self, name: str) -> Callable[[], int]:
        """Return what tells how many subscriptions a topic has that this node publishes."""
        return self.publishers[name].get_subscription_count if self.post is None else self.post.listeners(name)


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
