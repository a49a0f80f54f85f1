"""A ring of samples in shared memory: what a process of several nodes says to those that look at their own pace.

A recorder wants every sample and none of them at once. To give it each as a message of the middleware takes ten times
as long as to write it here, in the loop and in the recorder. One process writes; its forks, and the process that made
the ring, read. Nobody waits for anybody: a reader that is too late misses samples and knows how many bytes.

The kernel shares the pages (`mmap`, anonymous), so there is no name, no file, and nothing to clean up. A record is the
rank of its topic, the time of sending and the CDR bytes; it ends at a multiple of eight. The number of bytes ever
written is set behind the bytes themselves, as one store of an aligned word, and x86-64 keeps stores in order.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Container, Iterable
from mmap import mmap

SIZE = 1 << 23
"""Bytes of the ring: some three seconds of all streams at 1 kHz."""
_MARGIN = 1 << 16
"""Bytes before a full turn that a reader counts as lost already: the writer may be at work on them."""
_HEAD = struct.Struct("=IIq")
"""Length of the data, rank of the topic, time of sending [ns]."""
_PADS = tuple([bytes(-length & 7) for length in range(8)])
"""What fills a record up to a multiple of eight bytes, by the length of its data modulo eight."""
_WRITTEN, _OFFERED, _SLOTS = 0, 1, range(2, 14, 3)
"""Words before the ring: bytes ever written, and the ranks of the topics, a bit each. For each reader its process id,
the ranks it takes, and those of them that it subscribes to as well."""
EVERYTHING = range(64)
"""All ranks there can be."""

Record = tuple[int, int, bytes]
"""Rank of a topic in the table, time of sending [ns], CDR bytes."""


class Ring:
    """The ring of one process. Make it before the processes that share it are forked."""

    def __init__(self, size: int = SIZE) -> None:
        self._size, self._base = size, 8 * (_SLOTS.stop + 2)
        self._memory = mmap(-1, self._base + size)
        self._words = memoryview(self._memory)[: self._base].cast("Q")

    # The writer.

    def offer(self, ranks: Iterable[int]) -> None:
        """Say which topics come here from now on."""
        self._words[_OFFERED] = _mask(ranks)

    def readers(self, rank: int) -> tuple[int, int]:
        """Return how many take a topic, and how many of them subscribe to it as well; the dead are forgotten."""
        words, takes, subscribed = self._words, 0, 0
        for slot in _SLOTS:
            if words[slot] and words[slot + 1] >> rank & 1:
                if _lives(words[slot]):
                    takes, subscribed = takes + 1, subscribed + (words[slot + 2] >> rank & 1)
                else:
                    words[slot] = 0
        return takes, subscribed

    def put(self, records: Iterable[Record]) -> None:
        """Write records; nobody is woken, and a reader sees all of them or none."""
        parts: list[bytes] = []
        for rank, time, data in records:
            parts += (_HEAD.pack(len(data), rank, time), data, _PADS[len(data) & 7])
        record, memory, base, size = b"".join(parts), self._memory, self._base, self._size
        written = self._words[_WRITTEN]
        at = written % size
        end = at + len(record)
        if end <= size:
            memory[base + at : base + end] = record
        else:
            cut = size - at
            memory[base + at : base + size] = record[:cut]
            memory[base : base + end - size] = record[cut:]
        self._words[_WRITTEN] = written + len(record)

    # Readers.

    def join(self, takes: Iterable[int] = EVERYTHING) -> Reader:
        """Return what reads the topics of these ranks from now on.

        Raises:
            BufferError: there are readers enough.
        """
        words = self._words
        for slot in _SLOTS:
            if not words[slot] or not _lives(words[slot]):
                words[slot + 1], words[slot + 2] = _mask(takes), 0
                words[slot] = os.getpid()
                return Reader(self, slot)
        raise BufferError(f"{len(_SLOTS)} processes read this ring already")

    def take_too(self, slot: int, rank: int) -> None:
        """Note that the reader of a slot takes a topic more, to which it subscribes as well."""
        for word in (slot + 1, slot + 2):
            self._words[word] |= 1 << rank

    def offers(self, rank: int) -> bool:
        """Whether a topic comes here."""
        return bool(self._words[_OFFERED] >> rank & 1)

    @property
    def offered(self) -> set[int]:
        """Ranks of the topics that come here; none before the nodes have been made."""
        mask = self._words[_OFFERED]
        return {rank for rank in EVERYTHING if mask >> rank & 1}

    @property
    def written(self) -> int:
        """Bytes ever written."""
        return self._words[_WRITTEN]

    def copy(self, start: int, end: int) -> bytes | None:
        """Return the bytes between two positions; None when they have been overwritten."""
        memory, base, size = self._memory, self._base, self._size
        at, stop = base + start % size, base + end % size
        copied = memory[at:stop] if at <= stop else memory[at : base + size] + memory[base:stop]
        return copied if self.written - start <= size - _MARGIN else None


class Reader:
    """What one process reads from a ring.

    Attributes:
        lost: bytes that were overwritten before they were read.
    """

    def __init__(self, ring: Ring, slot: int) -> None:
        self.ring, self.lost = ring, 0
        self._slot, self._at = slot, ring.written

    def take_too(self, rank: int) -> None:
        """Read a topic more, to which this process subscribes as well."""
        self.ring.take_too(self._slot, rank)

    def read(self, ranks: Container[int] = EVERYTHING) -> list[Record]:
        """Return what has been written on the topics `ranks` since the last call, in order."""
        start, end = self._at, self.ring.written
        copied = self.ring.copy(start, end)
        self._at = end
        if copied is None:
            self.lost += end - start
            return []
        records, at, size, unpack, head = [], 0, len(copied), _HEAD.unpack_from, _HEAD.size
        while at < size:
            length, rank, time = unpack(copied, at)
            begin = at + head
            at = begin + length + (-length & 7)
            if rank in ranks:
                records.append((rank, time, copied[begin : begin + length]))
        return records


def _mask(ranks: Iterable[int]) -> int:
    return sum(1 << rank for rank in set(ranks))


def _lives(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except OSError:
        return False
    return True


_shared: list[Ring] = []


def share(rings: Iterable[Ring]) -> None:
    """Say which rings the processes forked from now on know; none ends it."""
    _shared[:] = rings


def shared_rings() -> list[Ring]:
    """Return the rings that this process was forked with."""
    return _shared
