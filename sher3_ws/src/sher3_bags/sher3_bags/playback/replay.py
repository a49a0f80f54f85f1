"""Replay a bag: its messages with the times at which they are due, as raw CDR bytes."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from sher3_common.stamps import SECOND
from sher3_description import NAMESPACE, TOPICS

from sher3_bags.codec.cdr import STAMP
from sher3_bags.contents import read_contents
from sher3_bags.errors import BagError, MissingTopicError, WrongTypeError
from sher3_bags.mcap.contents import Messages
from sher3_bags.mcap.rosbag2 import find_mcap
from sher3_bags.messages import TEXT

_STAMP = struct.Struct("<iI")
Stamps = Literal["shift", "keep"]
LEAST_RATE = 1e-3
"""Slowest replay: at a thousandth of real time one minute takes 17 hours; far below it, header stamps leave the range
of their seconds."""


class DueMessage(NamedTuple):
    """One message: when to publish it [ns], the topic's name in the table, its CDR bytes."""

    due: int
    topic: str
    data: bytes


class Replay:
    """The messages of a bag on another clock.

    Args:
        path: of the bag.
        topics: replay these; by default every topic of the table that the bag has.
        rate: speed, `LEAST_RATE` or more; 2 is twice as fast, `inf` is everything at once.
        stamps: `shift` moves and scales header stamps with the replay, `keep` leaves them as recorded.
        namespace: of the robot's topics in the bag.

    Raises:
        BagError: the bag does not read, the rate is out of range, or there is nothing to replay.
        MissingTopicError: a named topic is not in the bag.
        WrongTypeError: a topic has another type than in the table.
    """

    def __init__(
        self,
        path: str | Path,
        topics: Iterable[str] | None = None,
        *,
        rate: float = 1.0,
        stamps: Stamps = "shift",
        namespace: str = NAMESPACE,
    ) -> None:
        if not rate >= LEAST_RATE:
            remedy = "choose a greater one; 1 is real time"
            raise BagError("the rate must be positive and in range", path=path, value=rate, limit=f">= {LEAST_RATE}",
                           remedy=remedy)  # fmt: skip
        self.rate, self.stamps = rate, stamps
        self._contents = read_contents(find_mcap(Path(path)))
        named = self._named_channels(namespace)
        wanted = tuple(name for name in TOPICS if name in named.values()) if topics is None else tuple(topics)
        for name in wanted:
            if name not in named.values():
                raise MissingTopicError(name, tuple(named.values()))
        self.topics = wanted
        self._names = {key: name for key, name in named.items() if name in wanted}
        table = self._contents.messages
        rows = np.flatnonzero(np.isin(table.channel, list(self._names)))
        if not len(rows):
            raise BagError("nothing to replay", path=path, value=", ".join(named.values()), remedy="choose its topics")
        self._table: Messages = table.take(rows[np.argsort(table.log_time[rows], kind="stable")])
        self._first_stamp = self._earliest_stamp()

    def __len__(self) -> int:
        return len(self._table.channel)

    @property
    def duration(self) -> float:
        """Time [s] that the replay takes."""
        return float(self._table.log_time[-1] - self._table.log_time[0]) * 1e-9 / self.rate

    def density(self, topic: str) -> float:
        """Return the messages of a topic per second of the replay, on average; `inf` at infinite rate."""
        keys = [key for key, name in self._names.items() if name == topic]
        times = self._table.log_time[np.isin(self._table.channel, keys)]
        if len(times) < 2:
            return 0.0
        span = float(times[-1] - times[0]) * 1e-9 / self.rate
        return (len(times) - 1) / span if span > 0.0 else math.inf

    def messages(self, start: int) -> Iterator[DueMessage]:
        """Yield the messages in order.

        The earliest stamp of the recording becomes `start` [ns], and the first message is due then.
        """
        first = int(self._table.log_time[0])
        buffer = self._contents.buffer
        for row in range(len(self)):
            offset, length = int(self._table.offset[row]), int(self._table.length[row])
            topic = self._names[int(self._table.channel[row])]
            data = buffer[offset : offset + length].tobytes()
            if self.stamps == "shift":
                data = self._shifted(topic, data, start)
            yield DueMessage(start + self._scaled(int(self._table.log_time[row]) - first), topic, data)

    def _named_channels(self, namespace: str) -> dict[int, str]:
        prefix, named = namespace.rstrip("/") + "/", {}
        for key, channel in self._contents.channels.items():
            name = channel.topic.removeprefix(prefix)
            if channel.topic.startswith(prefix) and name in TOPICS:
                schema = self._contents.schemas.get(channel.schema_id)
                found = schema.name if schema else "none"
                if found != TOPICS[name].type:
                    raise WrongTypeError("wrong type", topic=name, value=found, limit=TOPICS[name].type)
                named[key] = name
        return named

    def _scaled(self, interval: int) -> int:
        if self.rate == 1.0:
            return interval  # exact: a float would round nanoseconds of long recordings
        return 0 if math.isinf(self.rate) else round(interval / self.rate)

    def _earliest_stamp(self) -> int:
        stamps = []
        for key, name in self._names.items():
            rows = np.flatnonzero(self._table.channel == key)
            if len(rows) and TOPICS[name].type != TEXT and self._table.length[rows[0]] >= STAMP + _STAMP.size:
                at = int(self._table.offset[rows[0]]) + STAMP
                seconds, nanoseconds = _STAMP.unpack_from(self._contents.buffer, at)
                stamps.append(seconds * SECOND + nanoseconds)
        return min(stamps, default=int(self._table.log_time[0]))

    def _shifted(self, topic: str, data: bytes, start: int) -> bytes:
        if TOPICS[topic].type == TEXT or len(data) < STAMP + _STAMP.size:
            return data
        seconds, nanoseconds = _STAMP.unpack_from(data, STAMP)
        stamp = start + self._scaled(seconds * SECOND + nanoseconds - self._first_stamp)
        return data[:STAMP] + _STAMP.pack(*divmod(stamp, SECOND)) + data[STAMP + _STAMP.size :]
