"""A whole MCAP file in memory: all messages in one buffer, with a table of where they lie."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Metadata, Schema
from numpy.typing import NDArray

from sher3_bags import kernels
from sher3_bags.errors import BagError, DamagedBagError, LimitError
from sher3_bags.mcap_file import Body, Record, body_of, check_data, read_bytes, records, unpack

MAX_TOTAL = 4 << 30
MAX_ATTACHMENT = 16 << 20


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
        path: of the file.
        schemas: by id.
        channels: by id.
        metadata: by record name.
        attachments: by name.
        buffer: all chunk bodies, uncompressed, one behind the other.
        messages: where the messages lie in `buffer`.
        chunks: number of chunks.
    """

    path: Path
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    buffer: NDArray[np.uint8] = field(default_factory=lambda: np.empty(0, np.uint8))
    messages: Messages = field(default_factory=lambda: Messages.empty(0))
    chunks: int = 0


def parse(path: Path, record: Record, contents: Contents) -> None:
    """Take a schema, channel, metadata record or attachment into `contents`; other records are ignored.

    Raises:
        DamagedBagError: it does not parse or fails its checksum.
        LimitError: an attachment is too large.
    """
    stream = ReadDataStream(io.BytesIO(record.content))
    try:
        if record.opcode == Opcode.SCHEMA:
            schema = Schema.read(stream)
            contents.schemas.setdefault(schema.id, schema)  # the summary repeats what stood before
        elif record.opcode == Opcode.CHANNEL:
            channel = Channel.read(stream)
            contents.channels.setdefault(channel.id, channel)
        elif record.opcode == Opcode.METADATA:
            entry = Metadata.read(stream)
            contents.metadata[entry.name] = entry.metadata
        elif record.opcode == Opcode.ATTACHMENT:
            if len(record.content) > MAX_ATTACHMENT:
                raise LimitError(
                    "an attachment is too large", path=path, value=len(record.content), limit=MAX_ATTACHMENT
                )
            (crc,) = struct.unpack_from("<I", record.content, len(record.content) - 4)
            if crc and zlib.crc32(record.content[:-4]) != crc:
                raise DamagedBagError("an attachment fails its checksum", path=path, offset=record.offset)
            attachment = Attachment.read(stream)
            contents.attachments[attachment.name] = attachment.data
    except (struct.error, UnicodeDecodeError, McapError) as error:
        raise DamagedBagError(f"a record does not parse ({error!r})", path=path, offset=record.offset) from error


def read_contents(path: Path) -> Contents:
    """Read a complete MCAP file.

    Raises:
        ForeignBagError: it is no MCAP file, or compressed in an unknown way.
        DamagedBagError: it is cut or corrupt.
        LimitError: it, or something in it, is too large.
    """
    contents = Contents(path)
    bodies: list[Body] = []
    data = read_bytes(path)
    for record in records(path, data):
        body = body_of(path, data, record)
        if body is not None:
            bodies.append(body)
        elif record.opcode == Opcode.DATA_END:
            check_data(path, data, record)
        else:
            parse(path, record, contents)
        contents.chunks += record.opcode == Opcode.CHUNK
    load(contents, bodies)
    unknown = set(np.flatnonzero(np.bincount(contents.messages.channel)).tolist()) - set(contents.channels)
    if unknown:
        what = "messages belong to a channel the file does not declare"
        raise DamagedBagError(what, path=path, offset=0, value=min(unknown))
    return contents


def load(contents: Contents, bodies: Sequence[Body], on_error: Callable[[Body, BagError], None] | None = None) -> None:
    """Uncompress bodies into `contents.buffer`, list their messages and parse the other records in them.

    Args:
        contents: filled.
        bodies: in file order.
        on_error: called for a body that does not unpack, which is then left out; by default the error is raised.

    Raises:
        LimitError: the bodies declare more than `MAX_TOTAL` bytes in all.
        BagError: a body does not unpack.
    """
    total = sum(body.size for body in bodies)
    if total > MAX_TOTAL:
        raise LimitError(
            "too much data", path=contents.path, value=total, limit=MAX_TOTAL, remedy="split the recording"
        )
    buffer, at = np.empty(total, np.uint8), 0
    for body in bodies:
        try:
            unpack(contents.path, body, buffer[at : at + body.size].data)
            at += body.size
        except BagError as error:
            if on_error is None:
                raise
            on_error(body, error)
    contents.buffer = buffer[:at]
    messages, others, _ = kernels.count_records(contents.buffer)
    contents.messages, other = Messages.empty(messages), np.empty(others, np.int64)
    kernels.index_records(contents.buffer, *contents.messages, other)
    for offset in other.tolist():
        opcode, length = struct.unpack_from("<BQ", contents.buffer, offset)
        start = offset + kernels.RECORD_HEAD
        parse(contents.path, Record(offset, opcode, contents.buffer[start : start + length].data), contents)
