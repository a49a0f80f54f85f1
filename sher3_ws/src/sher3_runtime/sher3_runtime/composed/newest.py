"""The newest samples of the rings of other processes, for nodes that look at their own pace.

Such a node has its subscription all the same: it knows by it how many speak on the topic, and who has no ring is heard.
"""

from __future__ import annotations

from collections import deque
from functools import cache

from sher3_description.topics import TOPICS

from sher3_runtime.composed.ring import Reader, shared_rings

_RANKS = {name: rank for rank, name in enumerate(TOPICS)}


class Newest:
    """The newest samples of each topic that somebody in this process looks at."""

    def __init__(self) -> None:
        self._readers: list[Reader] = [ring.join(()) for ring in shared_rings()]
        self._queues: dict[int, deque[bytes]] = {}

    def look_at(self, name: str, depth: int) -> int:
        """Keep the newest samples of a topic, at most `depth`; return its rank."""
        rank = _RANKS[name]
        self._queues[rank] = deque(maxlen=depth)
        for reader in self._readers:
            reader.take_too(rank)
        return rank

    def offers(self, rank: int) -> bool:
        """Whether a topic comes by a ring."""
        return any(reader.ring.offers(rank) for reader in self._readers)

    def take(self, rank: int) -> list[bytes]:
        """Return the samples (CDR bytes) since the last call, the oldest first."""
        queues = self._queues
        for reader in self._readers:
            if reader.ring.offers(rank):
                for number, _, data in reader.read(queues):
                    queues[number].append(data)
        taken = list(queues[rank])
        queues[rank].clear()
        return taken


@cache
def newest_of_rings() -> Newest | None:
    """Return what this process keeps of the rings it was forked with; None where there are none."""
    return Newest() if shared_rings() else None
