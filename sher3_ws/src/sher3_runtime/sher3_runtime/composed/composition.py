"""Several nodes in one process: samples go from `advertise` to `subscribe` as objects, in the tick.

A topic with both ends in the process has no reader of the middleware there: nobody outside can speak on it, and no
sample comes twice. The middleware gets the sample only while somebody outside listens, and not before the nodes of
the process have done their work. Latched topics keep their last sample for a node that is made later.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from time import monotonic_ns
from typing import Any

from sher3_description.topics import TOPICS, Topic

from sher3_runtime.composed.turn import Turn

ASK_NS = 50_000_000
"""Time [ns] after which a publisher asks again whether somebody outside listens."""
_RANKS = {name: rank for rank, name in enumerate(TOPICS)}

Offer = Callable[[Any], object]


class Composition:
    """The nodes of one process. Nodes made while it is entered (`with composition:`) belong to it."""

    def __init__(self) -> None:
        self._offers: dict[str, list[Offer]] = {}
        self._published: set[str] = set()
        self._latched: dict[str, Any] = {}
        self._leave: dict[str, list[Callable[[], None]]] = {}
        self._turns: list[Turn] = []
        self._outbox: deque[tuple[Callable[[Any], None], Any]] = deque()

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

    def keep_newest(self, topic: Topic, leave: Callable[[], None]) -> Callable[[], Any]:
        """Return `take()`: the newest sample since the last call, or None."""
        slot: deque[Any] = deque(maxlen=1)
        # First of all: the sample is there when another node's callback asks for it.
        self.offers(topic.name).insert(0, slot.append)
        self._leave.setdefault(topic.name, []).append(leave)
        if topic.name in self._latched:
            slot.append(self._latched[topic.name])

        def take() -> Any:
            try:
                return slot.pop()
            except IndexError:
                return None

        return take

    def publisher(
        self,
        topic: Topic,
        as_sent: Callable[[Any], Any] | None,
        send: Callable[[Any], None],
        listens: Callable[[], Any],
    ) -> Callable[[Any], None]:
        """Return `publish(sample)`.

        Args:
            topic: of the table.
            as_sent: gives a sample as a receiver outside would get it, where its numbers have fewer bits on the wire.
            send: encodes and gives a sample to the middleware.
            listens: tells whether somebody outside listens; asked every `ASK_NS`.
        """
        self._published.add(topic.name)
        offers, outbox, name = self.offers(topic.name), self._outbox, topic.name
        latched = topic.qos.durability == "transient_local"
        ask_at, wanted = 0, True

        def publish(sample: Any) -> None:
            nonlocal ask_at, wanted
            if as_sent is not None:
                sample = as_sent(sample)
            if latched:
                self._latched[name] = sample
            for offer in offers:
                offer(sample)
            if not latched and (now := monotonic_ns()) >= ask_at:
                ask_at, wanted = now + ASK_NS, bool(listens())
            if wanted:
                outbox.append((send, sample))

        return publish

    def inner(self, name: str) -> bool:
        """Whether the topic is published inside the process."""
        return name in self._published

    def begin(self) -> None:
        """Take the topics that are published inside off the middleware, and let every new node begin."""
        for name in self._published:
            for leave in self._leave.pop(name, []):
                leave()
        for turn in self._turns:
            turn.begin()

    def flush(self) -> None:
        """Give the middleware what was published since the last call; called when the work of a moment is done."""
        outbox = self._outbox
        while outbox:
            send, sample = outbox.popleft()
            send(sample)

    def __enter__(self) -> Composition:
        _composing.append(self)
        return self

    def __exit__(self, *_: object) -> None:
        _composing.pop()


_composing: list[Composition] = []


def composing() -> Composition | None:
    """Return the composition that nodes made now belong to, if any."""
    return _composing[-1] if _composing else None
