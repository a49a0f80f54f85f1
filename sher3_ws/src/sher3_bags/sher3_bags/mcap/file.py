"""The records of an MCAP file and the bodies of its chunks.

Sizes are bounded before memory is taken, checksums are verified, and nothing in the file is executed.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import lz4.frame
import numpy as np
import zstandard
from mcap.opcode import Opcode
from sher3_common import FileError
from sher3_common.files import text

from sher3_bags.errors import DamagedBagError, ForeignBagError, LimitError
from sher3_bags.mcap import kernels

MAGIC = b"\x89MCAP0\r\n"
MAX_FILE = 8 << 30
MAX_CHUNK = 64 << 20

_PRIVATE = 0x80  # opcodes from here on are for applications and are skipped
_CHUNK_HEAD = struct.Struct("<QQQII")


class Record(NamedTuple):
    """One record of the file: where it starts, its opcode and its content."""

    offset: int
    opcode: int
    content: memoryview


class Body(NamedTuple):
    """A sequence of records inside the file: a chunk, or a message outside of any chunk."""

    offset: int
    compression: str
    stored: memoryview
    size: int
    crc: int


def read_bytes(path: Path) -> memoryview:
    """Read a whole file of at most `MAX_FILE` bytes.

    Raises:
        ForeignBagError: there is no such file, or it is no MCAP file.
        LimitError: it is too large.
    """
    try:
        data = text.read_bytes(path, MAX_FILE)
    except FileError as error:
        kind = LimitError if error.limit is not None else ForeignBagError
        raise kind(error.reason, path=path, value=error.value, limit=error.limit, remedy=error.remedy) from error
    if data[: len(MAGIC)] != MAGIC:
        raise ForeignBagError("not an MCAP file", path=path, value=data[:8].hex() or "empty", limit=MAGIC.hex())
    return memoryview(data)


def records(path: Path, data: memoryview) -> Iterator[Record]:
    """Yield the records of the file, the footer included.

    Raises:
        DamagedBagError: The file ends or breaks before the footer and the closing magic bytes.
    """
    at = len(MAGIC)
    while True:
        if at + kernels.RECORD_HEAD > len(data):
            raise DamagedBagError("the file ends without a footer", path=path, offset=at)
        opcode, length = struct.unpack_from("<BQ", data, at)
        start = at + kernels.RECORD_HEAD
        if length > len(data) - start:
            raise DamagedBagError("a record is cut", path=path, offset=at, value=length, limit=len(data) - start)
        if not 0 < opcode <= Opcode.DATA_END and opcode < _PRIVATE:
            raise DamagedBagError("not a record", path=path, offset=at, value=opcode)
        yield Record(at, opcode, data[start : start + length])
        at = start + length
        if opcode == Opcode.FOOTER:
            break
    if data[at:] != MAGIC:
        raise DamagedBagError("the closing magic is missing", path=path, offset=at)


def body_of(path: Path, data: memoryview, record: Record) -> Body | None:
    """Return the body that a record holds; None when the record holds none.

    Raises:
        DamagedBagError: The head of a chunk is broken.
        LimitError: A chunk declares more than `MAX_CHUNK` bytes.
    """
    if record.opcode == Opcode.MESSAGE:
        stored = data[record.offset : record.offset + kernels.RECORD_HEAD + len(record.content)]
        return Body(record.offset, "", stored, len(stored), 0)
    if record.opcode != Opcode.CHUNK:
        return None
    content = record.content
    try:
        _, _, size, crc, name_length = _CHUNK_HEAD.unpack_from(content)
        at = _CHUNK_HEAD.size + name_length
        name = bytes(content[_CHUNK_HEAD.size : at]).decode("ascii")
        (length,) = struct.unpack_from("<Q", content, at)
    except (struct.error, UnicodeDecodeError) as error:
        raise DamagedBagError(f"a chunk header is broken ({error})", path=path, offset=record.offset) from error
    stored = content[at + 8 :]
    if length != len(stored):
        raise _wrong_size(path, record.offset, len(stored), length)
    if size > MAX_CHUNK:
        raise LimitError("a chunk is too large", path=path, value=size, limit=MAX_CHUNK, remedy="re-chunk the file")
    return Body(record.offset, name, stored, size, crc)


def unpack(path: Path, body: Body, out: memoryview) -> None:
    """Uncompress a body into `out`, which has its declared size.

    Raises:
        DamagedBagError: it does not give its declared size and checksum, or is no sequence of records.
        ForeignBagError: unknown compression.
    """
    try:
        length = _uncompress(path, body, out)
    except (zstandard.ZstdError, RuntimeError, EOFError) as error:
        raise DamagedBagError(f"a chunk does not decompress ({error})", path=path, offset=body.offset) from error
    if length != body.size:
        raise _wrong_size(path, body.offset, length, body.size)
    if body.crc and zlib.crc32(out) != body.crc:
        found = zlib.crc32(out)
        raise DamagedBagError("a chunk fails its checksum", path=path, offset=body.offset, value=found, limit=body.crc)
    _, _, bad = kernels.count_records(np.frombuffer(out, np.uint8))
    if bad >= 0:
        raise DamagedBagError("a chunk holds a broken record", path=path, offset=body.offset, value=bad)


def _uncompress(path: Path, body: Body, out: memoryview) -> int:
    if body.compression == "zstd":
        # Never let the frame, rather than the size that was checked, choose how much memory is taken.
        declared = zstandard.frame_content_size(body.stored) if body.size else 0
        if declared not in (-1, body.size):
            raise zstandard.ZstdError(f"frame of {declared} bytes in a chunk of {body.size}")
        return zstandard.ZstdDecompressor().stream_reader(body.stored).readinto(out) if body.size else 0
    if body.compression == "lz4":
        plain = lz4.frame.LZ4FrameDecompressor().decompress(bytes(body.stored), max_length=body.size)
    elif body.compression == "":
        plain = body.stored
    else:
        limit = "zstd, lz4 or none"
        raise ForeignBagError("unknown chunk compression", path=path, value=body.compression, limit=limit)
    if len(plain) == body.size:
        out[:] = plain
    return len(plain)


def _wrong_size(path: Path, offset: int, found: int, declared: int) -> DamagedBagError:
    what = "a chunk has another size than declared"
    return DamagedBagError(what, path=path, offset=offset, value=found, limit=declared)


def check_data(path: Path, data: memoryview, record: Record) -> None:
    """Verify the checksum of the data section, given its last record.

    Raises:
        DamagedBagError: it fails.
    """
    crc = int.from_bytes(record.content[:4], "little")
    if crc and zlib.crc32(data[: record.offset]) != crc:
        raise DamagedBagError("the data section fails its checksum", path=path, offset=record.offset)
