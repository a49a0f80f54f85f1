"""Replay a bag into the graph, on the clock grid."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sher3_description import TOPICS
from sher3_runtime import environment
from sher3_runtime.execution.spinning import spin
from sher3_runtime.ports import NODE_OPTIONS, advertise_raw, clock_of, on_tick, ports
from sher3_runtime.process import stop_on_signals

from sher3_bags.errors import TopicError
from sher3_bags.playback.replay import DueMessage, Replay

MOST_PER_TICK = 50
"""Messages of one topic that one tick may have to send: a 500 Hz recording at fifty times real time on a grid of 500
Hz."""
_DISCOVERY_TICKS = 250
_DELIVERY_TICKS = 50
_SETTLE_TICKS = 50
"""A subscriber may learn of its publisher later than that one of it, and until then gets nothing."""


class ReplayNode(Node):
    """Publishes the messages of a replay at the ticks at which they are due, in the order of the recording.

    The replay starts once `wait_for` subscribers are there per topic, or after half a second. It never becomes the
    second publisher of a topic: two sources of a command would fight over the robot. A tick sends what is due, several
    messages of a topic where the rate asks for it; what a tick may send is bounded, see `messages_per_tick`, and what
    is left over goes first in the next one.

    Args:
        replay: what to publish.
        wait_for: number of subscribers of every topic to wait for, without limit; 0 waits a fixed time.

    Raises:
        TopicError: the rate asks for more than `MOST_PER_TICK` messages of a topic per tick.
    """

    def __init__(self, replay: Replay, *, wait_for: int = 0, **options: Any) -> None:
        super().__init__("replay", **{**NODE_OPTIONS, **options})
        self.replay, self.sent, self.done = replay, 0, False
        self._wait_for = wait_for
        self._ticks = self._ticks_found = self._ticks_after = 0
        self._messages: Iterator[DueMessage] | None = None
        self._next: DueMessage | None = None
        period = clock_of(self).period_ns * 1e-9
        self._room = {name: messages_per_tick(replay, name, period) for name in replay.topics}
        self._publish = {
            name: advertise_raw(self, name, max(TOPICS[name].qos.depth, 2 * room)) for name, room in self._room.items()
        }
        on_tick(self, self._tick)

    def _tick(self, stamp: int) -> None:
        if self.done:
            self._ticks_after += 1
            return
        if not (self._messages or self._start(stamp)):
            return
        assert self._messages is not None
        room = dict(self._room)
        while self._next is not None and self._next.due <= stamp and room[self._next.topic]:
            self._publish[self._next.topic](self._next.data)
            self.sent += 1
            room[self._next.topic] -= 1
            self._next = next(self._messages, None)
        self.done = self._next is None

    @property
    def delivered(self) -> bool:
        """Whether enough ticks have passed since the last message for it to reach its subscribers."""
        return self._ticks_after > _DELIVERY_TICKS

    def _start(self, stamp: int) -> bool:
        self._ticks += 1
        if self._wait_for:
            counts = (publisher.get_subscription_count() for publisher in ports(self).publishers.values())
            self._ticks_found = self._ticks_found + 1 if min(counts) >= self._wait_for else 0
            if self._ticks_found <= _SETTLE_TICKS:
                return False
        elif self._ticks <= _DISCOVERY_TICKS:
            return False
        self._refuse_second_publisher()
        self._messages = self.replay.messages(stamp)
        self._next = next(self._messages, None)
        return True

    def _refuse_second_publisher(self) -> None:
        for name in self._publish:
            others = [
                info.node_name
                for info in self.get_publishers_info_by_topic(TOPICS[name].full_name)
                if info.node_name != self.get_name()
            ]
            if others:
                remedy = "stop that node, or leave the topic out of the replay"
                raise TopicError("has a publisher already", topic=name, value=", ".join(others), limit=0, remedy=remedy)


def messages_per_tick(replay: Replay, topic: str, period: float) -> int:
    """Return the most messages of a topic that one tick of `period` [s] sends.

    It is half a queue of the table, so that a burst fits the queues at both ends. A finite rate that needs more gets
    twice its need, to catch up after a lost tick; then only readers with queues of that depth get every message.

    Raises:
        TopicError: The rate needs more than `MOST_PER_TICK`.
    """
    half = max(1, TOPICS[topic].qos.depth // 2)
    if math.isinf(replay.rate):
        return half
    need = replay.density(topic) * period
    if need > MOST_PER_TICK * (1.0 + 1e-9):  # a rate of exactly the limit may round above it
        fastest = replay.rate * MOST_PER_TICK / need
        raise TopicError(
            f"a replay at {replay.rate:g} times real time needs too many messages per tick", topic=topic,
            value=round(need, 1), limit=MOST_PER_TICK,
            remedy=f"choose a rate of {fastest:.3g} or less, or inf, which takes the time the queues need",
        )  # fmt: skip
    return half if need <= half else 2 * math.ceil(need)


def run(replay: Replay, wait_for: int = 0, domain: int | None = None) -> int:
    """Replay in a process of its own until the end or a signal; return the number of messages published.

    `domain`: ROS domain id; that of the environment by default.

    Raises:
        TopicError: a topic has a publisher already, or the rate is too fast for it.
    """
    environment.apply(domain)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        stop = stop_on_signals()
        node = ReplayNode(replay, wait_for=wait_for)
        spin([node], stop=lambda: stop() or node.delivered, diagnostics=False)
        return node.sent
    finally:
        rclpy.try_shutdown()
