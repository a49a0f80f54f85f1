"""Read an MCAP file: all messages of all chunks in one buffer, with a table of where they lie.

Sizes are bounded before memory is taken, checksums are verified, and nothing in the file is executed.
"""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

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
MAX_CHUNKS = 1 << 20
MAX_ATTACHMENT = 16 << 20

_CHUNK_HEAD = struct.Struct("<QQQII")
_BELONGS_TO_SUMMARY = (Opcode.CHUNK_INDEX, Opcode.STATISTICS, Opcode.ATTACHMENT_INDEX, Opcode.METADATA_INDEX)


class Record(NamedTuple):
    """One record of the file: where it starts, its opcode and its content."""

    offset: int
    opcode: int
    content: memoryview


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
        channel: (n,) uint16, the message table in file order, with the next four.
        log_time: (n,) int64 ns.
        publish_time: (n,) int64 ns.
        offset: (n,) int64, start of the message's data in `buffer`.
        length: (n,) int64, its bytes.
        chunks: number of chunks.
        max_chunk: uncompressed bytes of the largest chunk.
    """

    path: Path
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    buffer: NDArray[np.uint8] = field(default_factory=lambda: np.empty(0, np.uint8))
    channel: NDArray[np.uint16] = field(default_factory=lambda: np.empty(0, np.uint16))
    log_time: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    publish_time: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    offset: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    length: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    chunks: int = 0
    max_chunk: int = 0

    def rows(self, channel_id: int) -> NDArray[np.int64]:
        """Return the message-table rows of a channel in order of log time."""
        rows = np.flatnonzero(self.channel == channel_id)
        times = self.log_time[rows]
        return rows if (np.diff(times) >= 0).all() else rows[np.argsort(times, kind="stable")]


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
            contents.schemas[schema.id] = schema
        elif record.opcode == Opcode.CHANNEL:
            channel = Channel.read(stream)
            contents.channels[channel.id] = channel
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
        ForeignBagError, DamagedBagError, LimitError: as above.
    """
    contents = Contents(path)
    bodies: list[tuple[int, bytes | memoryview]] = []
    total = 0
    data = read_bytes(path)
    for record in records(path, data):
        if record.opcode == Opcode.CHUNK:
            bodies.append((record.offset, unpack_chunk(path, record)))
            contents.chunks += 1
        elif record.opcode == Opcode.MESSAGE:
            bodies.append(
                (record.offset, data[record.offset : record.offset + kernels.RECORD_HEAD + len(record.content)])
            )
        else:
            parse(path, record, contents)
            continue
        total += len(bodies[-1][1])
        if total > MAX_TOTAL or contents.chunks > MAX_CHUNKS:
            raise LimitError("too much data", path=path, value=total, limit=MAX_TOTAL, remedy="split the recording")
    index_bodies(contents, bodies)
    return contents


def index_bodies(contents: Contents, bodies: list[tuple[int, bytes | memoryview]]) -> None:
    """Fill the message table from chunk bodies, given with the file offsets of their chunks.

    Raises:
        DamagedBagError: a body is no sequence of records, or a message belongs to no channel.
    """
    contents.buffer = np.frombuffer(b"".join(body for _, body in bodies), np.uint8)
    contents.max_chunk = max((len(body) for _, body in bodies), default=0)
    ends = np.cumsum([0] + [len(body) for _, body in bodies])
    counts = []
    for k, (offset, _) in enumerate(bodies):
        messages, others, bad = kernels.count_records(contents.buffer, ends[k], ends[k + 1])
        if bad >= 0:
            raise DamagedBagError(
                "a chunk holds a broken record", path=contents.path, offset=offset, value=int(bad - ends[k])
            )
        counts.append((messages, others))
    n = sum(messages for messages, _ in counts)
    contents.channel = np.empty(n, np.uint16)
    contents.log_time, contents.publish_time, contents.offset, contents.length = (
        np.empty(n, np.int64) for _ in range(4)
    )
    other = np.empty(sum(others for _, others in counts), np.int64)
    table = (contents.channel, contents.log_time, contents.publish_time, contents.offset, contents.length, other)
    kernels.index_records(contents.buffer, 0, len(contents.buffer), *table)
    view = memoryview(contents.buffer)
    for at in other:
        opcode, length = struct.unpack_from("<BQ", view, at)
        start = int(at) + kernels.RECORD_HEAD
        parse(contents.path, Record(int(at), opcode, view[start : start + length]), contents)
    unknown = np.setdiff1d(contents.channel, list(contents.channels))
    if len(unknown):
        raise DamagedBagError(
            "messages belong to a channel the file does not declare",
            path=contents.path,
            offset=0,
            value=int(unknown[0]),
        )
