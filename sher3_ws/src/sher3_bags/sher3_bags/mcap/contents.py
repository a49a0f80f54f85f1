"""A whole MCAP file in memory: all messages in one buffer, with a table of where they lie."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mcap.records import Channel, Schema
from numpy.typing import NDArray


class Messages(NamedTuple):
    """The table of all messages in file order, n rows."""

    channel: NDArray[np.uint16]
    sequence: NDArray[np.uint32]
    log_time: NDArray[np.int64]  # ns
    publish_time: NDArray[np.int64]  # ns
    offset: NDArray[np.int64]  # of the message's data in `Contents.buffer`
    length: NDArray[np.int64]

    @classmethod
    def empty(cls, n: int) -> Messages:
        """Return a table of n rows still to be filled."""
        return cls(np.empty(n, np.uint16), np.empty(n, np.uint32), *(np.empty(n, np.int64) for _ in range(4)))

    @classmethod
    def joined(cls, tables: Sequence[Messages]) -> Messages:
        """Return the rows of several tables, one table behind the other."""
        return Messages._make(np.concatenate(column) for column in zip(*tables, strict=True))

    def take(self, rows: NDArray[Any]) -> Messages:
        """Return the given rows (indices or a mask)."""
        return Messages._make(column[rows] for column in self)

    def rows(self, channel_id: int) -> NDArray[np.int64]:
        """Return the rows of a channel in order of log time."""
        rows = np.flatnonzero(self.channel == channel_id)
        times = self.log_time[rows]
        return rows if (np.diff(times) >= 0).all() else rows[np.argsort(times, kind="stable")]


@dataclass
class Contents:
    """An MCAP file in memory.

    Attributes:
        path: Path of the file.
        schemas: Schemas by their id.
        channels: Channels by their id.
        metadata: Metadata records by name.
        attachments: Attachments by name.
        buffer: All chunk bodies, uncompressed, one behind the other.
        messages: Where each message lies in `buffer`.
        chunks: Number of chunks.
    """

    path: Path
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    buffer: NDArray[np.uint8] = field(default_factory=lambda: np.empty(0, np.uint8))
    messages: Messages = field(default_factory=lambda: Messages.empty(0))
    chunks: int = 0
