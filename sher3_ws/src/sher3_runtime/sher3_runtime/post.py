"""Samples between the nodes of a graph in stepped time without the middleware: queues of bytes in one process.

The bytes are those that the middleware would carry, and a queue is as deep as its subscription asks: the newest stay.
So a node that is paused finds the same samples when it goes on, and garbage is garbage. Publishers and subscriptions
are the middleware's all the same, and can be counted there; only their samples take the short way.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import lru_cache
from operator import attrgetter
from typing import Any

Deliver = Callable[[bytes], None]
REMEMBERED = 32
"""Samples of a topic that are made once for all who hear them: as many as wait for the next look of a supervisor."""


class Box:
    """The queue of one subscription.

    Args:
        rank: place among all subscriptions; those that are ready together are served in this order.
        depth: samples that wait, the newest.
        deliver: takes a sample; None for a node that looks at its own pace.

    Attributes:
        held: whether its node is paused, so that samples only wait.
    """

    __slots__ = ("deliver", "held", "queue", "rank")

    def __init__(self, rank: int, depth: int, deliver: Deliver | None) -> None:
        self.rank, self.deliver, self.held = rank, deliver, False
        self.queue: deque[bytes] = deque(maxlen=depth)

    def take(self) -> bytes | None:
        """Return the oldest sample that waits; None without one."""
        return self.queue.popleft() if self.queue else None


class Post:
    """The boxes of a graph."""

    def __init__(self) -> None:
        self._boxes: dict[str, list[Box]] = {}
        self._kept: dict[str, bytes] = {}
        self._ready: list[Box] = []
        self._decoders: dict[str, Callable[[bytes], Any]] = {}
        self._count = 0

    def box(self, name: str, depth: int, deliver: Deliver | None) -> Box:
        """Return the box of a new subscription to a topic; it begins with the sample that the topic has kept."""
        self._count += 1
        box = Box(self._count, depth, deliver)
        self._boxes.setdefault(name, []).append(box)
        if name in self._kept:
            self._put(box, self._kept[name])
        return box

    def leave(self, name: str, box: Box) -> None:
        """Take a box away."""
        self._boxes[name].remove(box)
        box.queue.clear()

    def sender(self, name: str, latched: bool) -> Callable[[bytes], None]:
        """Return what sends bytes on a topic; `latched`: who comes later gets the last sample."""
        boxes = self._boxes.setdefault(name, [])

        def send(data: bytes) -> None:
            if latched:
                self._kept[name] = data
            for box in boxes:
                self._put(box, data)

        return send

    def decoder(self, name: str, decode: Callable[[bytes], Any]) -> Callable[[bytes], Any]:
        """Return what makes samples of a topic's bytes: each once, since nobody can change a sample."""
        return self._decoders.setdefault(name, lru_cache(REMEMBERED)(decode))

    def listeners(self, name: str) -> Callable[[], int]:
        """Return what tells how many subscriptions a topic has."""
        return self._boxes.setdefault(name, []).__len__

    def hold(self, boxes: list[Box], held: bool) -> None:
        """Let the samples of a node wait, or go on; what waits is then delivered."""
        for box in boxes:
            box.held = held
            if box.queue and box.deliver is not None and not held:
                self._ready.append(box)

    def deliver(self) -> bool:
        """Deliver until nothing waits that may be delivered; return whether there was anything."""
        anything = bool(self._ready)
        while self._ready:
            boxes, self._ready = sorted(self._ready, key=attrgetter("rank")), []
            for box in boxes:
                while box.queue and box.deliver is not None and not box.held:
                    box.deliver(box.queue.popleft())
        return anything

    def _put(self, box: Box, data: bytes) -> None:
        if not box.queue and box.deliver is not None and not box.held:
            self._ready.append(box)
        box.queue.append(data)
