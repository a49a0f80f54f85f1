"""Who publishes a topic and still lives.

The middleware forgets a publisher that was killed when its lease is over, seconds later. Its identity tells sooner:
Fast DDS writes the lower half of the process number into it. A publisher counts as dead when its process was seen here
before and is gone; one on another computer, in another container or of another vendor is left to its lease.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from rclpy.node import Node
from sher3_description import TOPICS

VENDOR = b"\x01\x0f"
"""First bytes of an identity that Fast DDS made; then two of the computer, and two of the process, low byte first."""
PARTICIPANT = 12
"""Length of the part of an identity that all publishers of a process share, bytes."""
PAUSE_NS = 1_000_000_000
"""Time [ns] after which somebody who asks again may meet another publisher: shorter than the lease."""
_PROCESSES = Path("/proc")


class Publishers:
    """The living publishers of topics of the table, as one node knows them."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._full: dict[str, str] = {}
        self._asked: dict[str, tuple[int, int]] = {}
        self._processes: dict[bytes, list[int]] = {}

    def count(self, name: str, now: int, known: Callable[[], int] | None = None) -> int:
        """Return how many of the table's type there are at `now` [ns]; nobody is looked up twice while one is known.

        Args:
            name: of the topic.
            now: in the order of the calls.
            known: tells how many the middleware knows; a subscription does it for less than the graph, which is asked
                otherwise.
        """
        topic = TOPICS[name]
        if (full := self._full.get(name)) is None:  # asked in every tick: a node's names never change
            full = self._full[name] = self._node.resolve_topic_name(topic.full_name)
        number = known() if known else self._node.count_publishers(full)
        before, asked = self._asked.get(name, (-1, 0))
        self._asked[name] = number, now
        if number == before <= 1 and now - asked < PAUSE_NS:
            return number
        found = [info for info in self._node.get_publishers_info_by_topic(full) if info.topic_type == topic.type]
        return sum(self._lives(bytes(info.endpoint_gid)) for info in found)

    def _lives(self, identity: bytes) -> bool:
        """Return whether a publisher lives; its process is looked for once, then only asked for."""
        participant = identity[:PARTICIPANT]
        if participant not in self._processes:
            self._processes[participant] = processes_of(identity)
        processes = self._processes[participant]
        return not processes or any(map(runs, processes))


def processes_of(identity: bytes) -> list[int]:
    """Return the numbers of the running processes of this computer that fit the identity of a publisher."""
    if identity[: len(VENDOR)] != VENDOR:
        return []
    low = int.from_bytes(identity[4:6], "little")
    numbers = [int(entry.name) for entry in _PROCESSES.iterdir() if entry.name.isdigit()]
    return [number for number in numbers if number & 0xFFFF == low and runs(number)]


def runs(number: int) -> bool:
    """Return whether a process runs; one that has ended may still wait for its parent to take note."""
    try:
        text = (_PROCESSES / str(number) / "stat").read_text()
    except OSError:
        return False
    return text.rpartition(")")[2].split()[0] not in "ZX"
