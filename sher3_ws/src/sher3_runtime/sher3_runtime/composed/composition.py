"""Several nodes in one process: samples go from `advertise` to `subscribe` as objects, in the tick.

A topic with both ends in the process has no reader of the middleware there: nobody outside can speak on it, and no
sample comes twice. The middleware gets the sample only while somebody outside listens, and not before the nodes of
the process have done their work. Latched topics keep their last sample for a node that is made later. Those that look
at their own pace (`ring`) are no reason to send anything through the middleware.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from operator import attrgetter
from time import monotonic_ns
from typing import Any

from sher3_description.topics import AT_ONCE, MANY_SENDERS, TOPICS, Topic

from sher3_runtime.composed.outside import Outside, Take
from sher3_runtime.composed.ring import Ring
from sher3_runtime.composed.turn import Turn

ASK_NS = 50_000_000
"""Time [ns] after which a publisher asks again whether somebody outside listens."""
REPEATS = 10
"""Samples after a change of what is heard `AT_ONCE` that the middleware gets too: any one of them may be lost."""
STRIDE = 3
"""Periods between the slow callbacks of a process; prime to 10, 25 and 50, the periods of a twentieth of a second."""
_RANKS = {name: rank for rank, name in enumerate(TOPICS)}

Offer = Callable[[Any], object]
Send = Callable[[bytes], None]


class Composition:
    """The nodes of one process. Nodes made while it is entered (`with composition:`) belong to it.

    Args:
        ring: for those beside the process that look at their own pace; None where there are none.
    """

    def __init__(self, ring: Ring | None = None) -> None:
        self._ring = ring
        self._offers: dict[str, list[Offer]] = {}
        self._published: set[str] = set()
        self._latched: dict[str, Any] = {}
        self._leave: dict[str, list[Callable[[], None]]] = {}
        self._outside: dict[tuple[str, int], Outside] = {}
        self._turns: list[Turn] = []
        self._slow_ticks = 0
        self._outbox: list[tuple[Callable[[Any], bytes], Any, Send | None, int | None]] = []
        self._now: Callable[[], int] = monotonic_ns

    def offset(self, every: int) -> int:
        """Return the phase offset, in periods, of a callback due every so many, so that slow ones do not coincide."""
        self._slow_ticks += 1
        return STRIDE * self._slow_ticks % every

    def turn(self) -> Turn:
        """Return the turn of a new node."""
        self._turns.append(Turn())
        return self._turns[-1]

    def offers(self, name: str) -> list[Offer]:
        """Return the list, growing with each subscription, of what takes a sample of the topic inside the process."""
        return self._offers.setdefault(name, [])

    def hear(
        self, topic: Topic, turn: Turn, receive: Callable[[Any], None], depth: int, leave: Callable[[], None]
    ) -> Callable[[Any], None]:
        """Subscribe inside the process; return what takes a sample, from inside or from the middleware.

        Args:
            topic: of the table.
            turn: of the subscribing node.
            receive: gets the samples, in the node's turn.
            depth: samples kept while the node is at work.
            leave: takes the subscription off the middleware; called at `begin` when the topic is published inside.
        """
        offer = turn.inlet(_RANKS[topic.name], receive, depth)
        self.offers(topic.name).append(offer)
        self._leave.setdefault(topic.name, []).append(leave)
        if topic.name in self._latched:
            offer(self._latched[topic.name])
        return offer

    def keep(self, topic: Topic, depth: int, listen: Callable[[], tuple[Take, Callable[[], None]]], pause: int) -> Take:
        """Return `take()`: the newest samples since the last call, at most `depth`, for who looks at its own pace.

        Args:
            topic: of the table.
            depth: samples kept.
            listen: subscribes, and returns what asks the middleware and what takes the subscription off it; called once
                for all nodes that want this topic in this depth.
            pause: time [ns] for which the middleware is not asked again, by whichever node.
        """
        name, queue = topic.name, deque[Any](maxlen=depth)
        # First of all: the sample is there when another node's callback asks for it.
        self.offers(name).insert(0, queue.append)
        if name in self._latched:
            queue.append(self._latched[name])
        if (name, depth) not in self._outside:
            ask, leave = listen()
            self._outside[name, depth] = Outside(ask, pause)
            self._leave.setdefault(name, []).append(leave)
        outside = self._outside[name, depth]
        outside.queues.append(queue)

        def take() -> list[Any]:
            if name not in self._published:
                outside.look()
            samples = list(queue)
            queue.clear()
            return samples

        return take

    def beside(self, name: str) -> Callable[[], bool]:
        """Return what tells whether somebody reads the topic from the ring."""
        ring = self._ring if _goes_by_ring(TOPICS[name]) else None
        rank = _RANKS[name]
        return (lambda: False) if ring is None else lambda: ring.readers(rank)[0] > 0

    def publisher(
        self,
        topic: Topic,
        as_sent: Callable[[Any], Any] | None,
        encode: Callable[[Any], bytes],
        send: Send,
        listens: Callable[[], int],
        now: Callable[[], int],
    ) -> Callable[[Any], None]:
        """Return `publish(sample)`.

        Args:
            topic: of the table.
            as_sent: gives a sample as a receiver outside would get it, where its numbers have fewer bits on the wire.
            encode: gives the bytes of a sample.
            send: gives bytes to the middleware.
            listens: tells how many outside listen; asked every `ASK_NS`.
            now: time of the graph [ns].
        """
        self._published.add(topic.name)
        self._now = now
        offers, outbox, name, rank = self.offers(topic.name), self._outbox, topic.name, _RANKS[topic.name]
        latched = topic.qos.durability == "transient_local"
        ring = self._ring if _goes_by_ring(topic) else None
        ask_at, outside, beside = 0, True, False
        of_note, noted, left = attrgetter(AT_ONCE[name]) if name in AT_ONCE else None, None, 0

        def publish(sample: Any) -> None:
            nonlocal ask_at, outside, beside, noted, left
            if as_sent is not None:
                sample = as_sent(sample)
            if latched:
                self._latched[name] = sample
            for offer in offers:
                offer(sample)
            if not latched and (at := monotonic_ns()) >= ask_at:
                takes, subscribed = (0, 0) if ring is None else ring.readers(rank)
                ask_at, outside, beside = at + ASK_NS, listens() > subscribed, takes > 0
            if of_note is not None:
                left -= 1
                if (value := of_note(sample)) != noted:
                    noted, left = value, REPEATS
            if outside or beside:
                outbox.append((encode, sample, send if outside or left > 0 else None, rank if beside else None))

        return publish

    def inner(self, name: str) -> bool:
        """Whether the topic is published inside the process."""
        return name in self._published

    def begin(self) -> None:
        """Take the topics that are published inside off the middleware, and let every new node begin."""
        for name in self._published:
            for leave in self._leave.pop(name, []):
                leave()
        if self._ring is not None:
            self._ring.offer(_RANKS[name] for name in self._published if _goes_by_ring(TOPICS[name]))
        for turn in self._turns:
            turn.begin()

    def flush(self) -> None:
        """Let out what was published since the last call; called when the work of a moment is done."""
        if not self._outbox:
            return
        leaving, records, now = self._outbox.copy(), [], self._now()
        self._outbox.clear()
        for encode, sample, send, rank in leaving:
            data = encode(sample)
            if rank is not None:
                records.append((rank, now, data))
            if send is not None:
                send(data)
        if records and self._ring is not None:
            self._ring.put(records)

    def __enter__(self) -> Composition:
        _composing.append(self)
        return self

    def __exit__(self, *_: object) -> None:
        _composing.pop()


def _goes_by_ring(topic: Topic) -> bool:
    """Whether a topic can be read from the ring alone: a stream of one sender, who is in this process."""
    return topic.qos.durability == "volatile" and topic.name not in MANY_SENDERS


_composing: list[Composition] = []


def composing() -> Composition | None:
    """Return the composition that nodes made now belong to, if any."""
    return _composing[-1] if _composing else None
