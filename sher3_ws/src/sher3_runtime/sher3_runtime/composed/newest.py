"""The newest samples of the rings of other processes, for nodes that look at their own pace.

Such a node has its subscription all the same: it knows by it how many speak on the topic, and who has no ring is heard.
"""

from __future__ import annotations

from functools import cache

from sher3_description.topics import TOPICS

from sher3_runtime.composed.ring import Reader, shared_rings

_RANKS = {name: rank for rank, name in enumerate(TOPICS)}


class Newest:
    """The newest sample of each topic that somebody in this process looks at."""

    def __init__(self) -> None:
        self._readers: list[Reader] = [ring.join(()) for ring in shared_rings()]
        self._data: dict[int, bytes | None] = {}

    def look_at(self, name: str) -> int:
        """Keep the newest sample of a topic; return its rank."""
        rank = _RANKS[name]
        self._data[rank] = None
        for reader in self._readers:
            reader.take_too(rank)
        return rank

    def take(self, rank: int) -> bytes | None:
        """Return the newest sample (CDR bytes) since the last call; None without one."""
        kept = self._data
        for reader in self._readers:
            if reader.ring.offers(rank):
                kept.update({number: data for number, _, data in reader.read(kept)})
        newest, kept[rank] = kept[rank], None
        return newest


@cache
def newest_of_rings() -> Newest | None:
    """Return what this process keeps of the rings it was forked with; None where there are none."""
    return Newest() if shared_rings() else None
