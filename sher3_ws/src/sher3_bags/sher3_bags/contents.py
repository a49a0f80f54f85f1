"""Read a whole MCAP file into memory."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Metadata, Schema

from sher3_bags.errors import BagError, DamagedBagError, LimitError
from sher3_bags.former_topics import translate_commands
from sher3_bags.mcap import kernels
from sher3_bags.mcap.contents import Contents, Messages
from sher3_bags.mcap.file import Body, Record, body_of, check_data, read_bytes, records, unpack

MAX_TOTAL = 4 << 30
MAX_ATTACHMENT = 16 << 20


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
    """Read a complete MCAP file; commands of older recordings appear on their topics of today (`former_topics`).

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
    translate_commands(contents)
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
