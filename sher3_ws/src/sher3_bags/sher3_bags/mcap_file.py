"""Read an MCAP file: all messages of all chunks in one buffer, with a table of where they lie.

Sizes are bounded before memory is taken, checksums are verified, and nothing in the file is executed.
"""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import lz4.frame
import numpy as np
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Metadata, Schema
from numpy.typing import NDArray

from sher3_bags import kernels
from sher3_bags.errors import DamagedBagError, ForeignBagError, LimitError

MAGIC = b"\x89MCAP0\r\n"
MAX_FILE = 8 << 30
MAX_CHUNK = 64 << 20
MAX_TOTAL = 4 << 30
MAX_ATTACHMENT = 16 << 20

_CHUNK_HEAD = struct.Struct("<QQQII")


class Record(NamedTuple):
    """One record of the file: where it starts, its opcode and its content."""

    offset: int
    opcode: int
    content: memoryview


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
        max_chunk: uncompressed bytes of the largest chunk.
    """

    path: Path
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    buffer: NDArray[np.uint8] = field(default_factory=lambda: np.empty(0, np.uint8))
    messages: Messages = field(default_factory=lambda: Messages.empty(0))
    chunks: int = 0
    max_chunk: int = 0


def read_bytes(path: Path) -> memoryview:
    """Read a whole file of at most `MAX_FILE` bytes.

    Raises:
        ForeignBagError: there is no such file, or it is no MCAP file.
        LimitError: it is too large.
    """
    try:
        size = path.stat().st_size
        if size > MAX_FILE:
            raise LimitError("file too large", path=path, value=size, limit=MAX_FILE, remedy="split the recording")
        data = path.read_bytes()
    except OSError as error:
        raise ForeignBagError(f"cannot be read: {error.strerror}", path=path) from error
    if data[: len(MAGIC)] != MAGIC:
        raise ForeignBagError("not an MCAP file", path=path, value=data[:8].hex() or "empty", limit=MAGIC.hex())
    return memoryview(data)


def records(path: Path, data: memoryview) -> Iterator[Record]:
    """Yield the records up to and with the footer.

    Raises:
        DamagedBagError: the file ends or breaks before the footer and the closing magic.
    """
    at = len(MAGIC)
    while True:
        if at + kernels.RECORD_HEAD > len(data):
            raise DamagedBagError("the file ends without a footer", path=path, offset=at)
        opcode, length = struct.unpack_from("<BQ", data, at)
        start = at + kernels.RECORD_HEAD
        if length > len(data) - start:
            raise DamagedBagError("a record is cut", path=path, offset=at, value=length, limit=len(data) - start)
        if not 0 < opcode <= Opcode.DATA_END:
            raise DamagedBagError("not a record", path=path, offset=at, value=opcode)
        yield Record(at, opcode, data[start : start + length])
        at = start + length
        if opcode == Opcode.FOOTER:
            break
    if data[at:] != MAGIC:
        raise DamagedBagError("the closing magic is missing", path=path, offset=at)


def unpack_chunk(path: Path, record: Record) -> bytes:
    """Return the uncompressed body of a chunk.

    Raises:
        DamagedBagError: it does not decompress to its declared size and checksum.
        LimitError: it declares a larger body than `MAX_CHUNK`.
        ForeignBagError: unknown compression.
    """
    content, offset = record.content, record.offset
    try:
        _, _, size, crc, name_length = _CHUNK_HEAD.unpack_from(content)
        at = _CHUNK_HEAD.size + name_length
        name = bytes(content[_CHUNK_HEAD.size : at]).decode("ascii")
        (stored,) = struct.unpack_from("<Q", content, at)
    except (struct.error, UnicodeDecodeError) as error:
        raise DamagedBagError(f"a chunk header is broken ({error})", path=path, offset=offset) from error
    body = content[at + 8 :]
    if stored != len(body):
        raise DamagedBagError(
            "a chunk has another size than declared", path=path, offset=offset, value=len(body), limit=stored
        )
    if size > MAX_CHUNK:
        raise LimitError("a chunk is too large", path=path, value=size, limit=MAX_CHUNK, remedy="re-chunk the file")
    plain = _decompress(path, offset, name, body, size)
    if len(plain) != size:
        raise DamagedBagError(
            "a chunk has another size than declared", path=path, offset=offset, value=len(plain), limit=size
        )
    if crc and zlib.crc32(plain) != crc:
        raise DamagedBagError(
            "a chunk fails its checksum", path=path, offset=offset, value=zlib.crc32(plain), limit=crc
        )
    return plain


def _decompress(path: Path, offset: int, name: str, body: memoryview, size: int) -> bytes:
    try:
        if name == "zstd":
            declared = zstandard.frame_content_size(body)
            if declared not in (
                -1,
                size,
            ):  # never let the frame, rather than the chunk, choose how much memory is taken
                raise zstandard.ZstdError(f"frame of {declared} bytes in a chunk of {size}")
            return zstandard.ZstdDecompressor().decompress(body, max_output_size=size) if size else b""
        if name == "lz4":
            return bytes(lz4.frame.LZ4FrameDecompressor().decompress(bytes(body), max_length=size))
        if name == "":
            return bytes(body)
    except (zstandard.ZstdError, RuntimeError, EOFError) as error:
        raise DamagedBagError(f"a chunk does not decompress ({error})", path=path, offset=offset) from error
    raise ForeignBagError("unknown chunk compression", path=path, value=name, limit="zstd, lz4 or none")


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
    bodies: list[bytes | memoryview] = []
    total = 0
    data = read_bytes(path)
    for record in records(path, data):
        body = message_body(path, data, record)
        if body is None:
            parse(path, record, contents)
            continue
        bad = first_bad_byte(body)
        if bad is not None:
            raise DamagedBagError("a chunk holds a broken record", path=path, offset=record.offset, value=bad)
        total += len(body)
        if total > MAX_TOTAL:
            raise LimitError("too much data", path=path, value=total, limit=MAX_TOTAL, remedy="split the recording")
        bodies.append(body)
        contents.chunks += record.opcode == Opcode.CHUNK
    index_bodies(contents, bodies)
    unknown = set(np.flatnonzero(np.bincount(contents.messages.channel)).tolist()) - set(contents.channels)
    if unknown:
        what = "messages belong to a channel the file does not declare"
        raise DamagedBagError(what, path=path, offset=0, value=min(unknown))
    return contents


def message_body(path: Path, data: memoryview, record: Record) -> bytes | memoryview | None:
    """Return the records inside a chunk, a message outside of any chunk as it stands, or None for other records.

    Raises:
        DamagedBagError: the chunk is corrupt, or the record is the data end and the file before it is.
    """
    if record.opcode == Opcode.DATA_END:
        crc = int.from_bytes(record.content[:4], "little")
        if crc and zlib.crc32(data[: record.offset]) != crc:
            raise DamagedBagError("the data section fails its checksum", path=path, offset=record.offset)
    if record.opcode == Opcode.CHUNK:
        return unpack_chunk(path, record)
    if record.opcode == Opcode.MESSAGE:
        return data[record.offset : record.offset + kernels.RECORD_HEAD + len(record.content)]
    return None


def first_bad_byte(body: bytes | memoryview) -> int | None:
    """Return where a body stops being a sequence of records, or None when it is one."""
    _, _, bad = kernels.count_records(np.frombuffer(body, np.uint8))
    return None if bad < 0 else int(bad)


def index_bodies(contents: Contents, bodies: list[bytes | memoryview]) -> None:
    """Join bodies without bad bytes in `contents.buffer`, list their messages and parse the other records in them."""
    contents.buffer = np.frombuffer(b"".join(bodies), np.uint8)
    contents.max_chunk = max(map(len, bodies), default=0)
    messages, others, _ = kernels.count_records(contents.buffer)
    contents.messages, other = Messages.empty(messages), np.empty(others, np.int64)
    kernels.index_records(contents.buffer, *contents.messages, other)
    view = memoryview(contents.buffer)
    for at in other.tolist():
        opcode, length = struct.unpack_from("<BQ", view, at)
        start = at + kernels.RECORD_HEAD
        parse(contents.path, Record(at, opcode, view[start : start + length]), contents)
