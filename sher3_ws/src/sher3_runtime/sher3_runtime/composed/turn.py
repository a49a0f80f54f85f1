"""One callback of a node at a time: a node written for a process of its own runs as it is in a shared one.

A publisher hands a sample over at once when the receiving node is at rest. When that node is at work (it has published
something itself and is on the stack, or it waits for its device), the sample waits in an inlet, and is handed over as
soon as the node's work ends. One thread of the process runs node code at a time (`relief`), so nothing here is locked.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any


class Inlet:
    """Samples of one topic on their way to a node: the newest `depth` of them, as in a queue of the middleware."""

    __slots__ = ("rank", "receive", "samples")

    def __init__(self, rank: int, receive: Callable[[Any], None], depth: int) -> None:
        self.rank, self.receive = rank, receive
        self.samples: deque[Any] = deque(maxlen=depth)


class Turn:
    """The right to run a node's code.

    Attributes:
        taken: The node is at work. True until `begin`, too: nothing is delivered to a node that is being made.
    """

    __slots__ = ("_inlets", "_opened", "_waits", "taken")

    def __init__(self, opened: bool = False) -> None:
        self.taken = not opened
        self._opened = opened
        self._waits = False
        self._inlets: list[Inlet] = []

    def inlet(self, rank: int, receive: Callable[[Any], None], depth: int) -> Callable[[Any], None]:
        """Add an inlet and return what takes a sample; samples that wait are handed over in the order of `rank`."""
        inlet = Inlet(rank, receive, depth)
        # In place: `offer` below looks at this list.
        self._inlets.append(inlet)
        self._inlets.sort(key=lambda i: i.rank)

        def offer(sample: Any) -> None:
            if self.taken or self._waits:
                inlet.samples.append(sample)
                self._waits = True
            else:  # nearly always: nothing has to be put in order
                self.taken = True
                try:
                    receive(sample)
                finally:
                    self.taken = False
            if self._waits and not self.taken:
                self.serve()

        return offer

    def begin(self) -> None:
        """Let the node begin."""
        if not self._opened:
            self._opened, self.taken = True, False
            if self._waits:
                self.serve()

    def serve(self) -> None:
        """Hand over what waits; called while the node is at rest."""
        while (inlet := self._next()) is not None:
            self.taken = True
            try:
                inlet.receive(inlet.samples.popleft())
            finally:
                self.taken = False
        self._waits = False

    def _next(self) -> Inlet | None:
        for inlet in self._inlets:
            if inlet.samples:
                return inlet
        return None

    def guard(self, callback: Callable[..., None]) -> Callable[..., None]:
        """Return the callback so that it takes this turn; it is not called while the node is at work."""

        def guarded(*arguments: Any) -> None:
            if not self.taken:
                with self:
                    callback(*arguments)

        return guarded

    def __enter__(self) -> None:
        self.taken = True

    def __exit__(self, *_: object) -> None:
        self.taken = False
        if self._waits:
            self.serve()
