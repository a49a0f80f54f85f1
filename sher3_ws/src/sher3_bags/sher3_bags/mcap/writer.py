"""Write MCAP so that a cut file loses at most the chunk that was being written.

Every chunk is one write, followed by its index. Metadata, attachments and channels are written before the chunks that
need them and are repeated in the summary. Records are encoded by the `mcap` package; the bodies of the chunks come
from `kernels.pack_messages` or from the `Recorder`.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from typing import BinaryIO

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from numpy.typing import NDArray
from sher3_description import Qos

from sher3_bags.mcap.file import MAGIC
from sher3_bags.mcap.qos import offered_qos_text
from sher3_bags.messages import schema_text

CHUNK_LIMIT = 256 << 10
LIBRARY = "sher3_bags"
_LEVEL = 1


class McapWriter:
    """Writes one MCAP file to a binary stream; `close` adds the summary.

    Attributes:
        counts: messages per channel id.
        start, end: first and last log time [ns], 0 before the first message.
    """

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._at = self._crc = 0
        self._schemas: dict[str, Schema] = {}
        self._channels: dict[str, Channel] = {}
        self._chunks: list[ChunkIndex] = []
        self._attachments: list[AttachmentIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._compress = zstandard.ZstdCompressor(level=_LEVEL).compress
        self.counts: dict[int, int] = {}
        self.start = self.end = 0
        self._write(MAGIC)
        self._put(Header("ros2", LIBRARY))

    def add_metadata(self, name: str, entries: Mapping[str, str]) -> None:
        """Add a metadata record."""
        offset, length = self._put(Metadata(name, dict(entries)))
        self._metadata.append(MetadataIndex(offset, length, name))

    def add_attachment(self, name: str, media_type: str, data: bytes, time: int = 0) -> None:
        """Add an attachment; time in ns."""
        offset, length = self._put(Attachment(time, time, name, media_type, data))
        self._attachments.append(AttachmentIndex(offset, length, time, time, len(data), name, media_type))

    def channel(self, topic: str, type_name: str, qos: Qos | None = None) -> int:
        """Return the id of a topic's channel, by absolute name.

        At the first use of the topic its schema and channel are written.
        """
        if topic not in self._channels:
            if type_name not in self._schemas:
                schema = Schema(len(self._schemas) + 1, schema_text(type_name).encode(), "ros2msg", type_name)
                self._put(schema)
                self._schemas[type_name] = schema
            metadata = {"offered_qos_profiles": offered_qos_text(qos or Qos())}
            channel = Channel(len(self._channels) + 1, topic, "cdr", metadata, self._schemas[type_name].id)
            self._put(channel)
            self._channels[topic] = channel
            self.counts[channel.id] = 0
        return self._channels[topic].id

    def adopt(self, channel: Channel, schema: Schema | None) -> None:
        """Take over a channel of another file with its id and schema; not to be mixed with `channel`."""
        if schema is not None and str(schema.id) not in self._schemas:
            self._put(schema)
            self._schemas[str(schema.id)] = schema
        self._put(channel)
        self._channels[channel.topic] = channel
        self.counts[channel.id] = 0

    def add_chunk(
        self,
        body: bytes | memoryview,
        channel: NDArray[np.integer],
        log_time: NDArray[np.int64],
        position: NDArray[np.int64],
    ) -> None:
        """Write message records as one chunk with its message indexes.

        Args:
            body: the records, one behind the other.
            channel: (n,) channel of each message, in the order of the body.
            log_time: (n,) ns.
            position: (n,) start of each record in the body.
        """
        start, end = int(log_time.min()), int(log_time.max())
        data = self._compress(body)
        builder = RecordBuilder()
        Chunk("zstd", data, end, start, zlib.crc32(body), len(body)).write(builder)
        chunk_length, indexes, offsets = builder.count, [], {}
        at = self._at + chunk_length
        for key in np.unique(channel):
            mine = channel == key
            offsets[int(key)] = at
            indexes.append(_message_index(int(key), log_time[mine], position[mine]))
            at += len(indexes[-1])
            self.counts[int(key)] += int(mine.sum())
        index_length = sum(map(len, indexes))
        entry = ChunkIndex(chunk_length, self._at, "zstd", len(data), end, index_length, offsets, start, len(body))
        self.start = start if not self._chunks else min(self.start, start)
        self.end = max(self.end, end)
        self._chunks.append(entry)
        self._write(builder.end() + b"".join(indexes))

    def close(self) -> None:
        """Write data end, summary and footer; the stream stays open."""
        self._put(DataEnd(self._crc))
        summary_start, summary = self._at, RecordBuilder()
        groups: list[tuple[Opcode, list[McapRecord]]] = [
            (Opcode.SCHEMA, list(self._schemas.values())),
            (Opcode.CHANNEL, list(self._channels.values())),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.CHUNK_INDEX, list(self._chunks)),
            (Opcode.ATTACHMENT_INDEX, list(self._attachments)),
            (Opcode.METADATA_INDEX, list(self._metadata)),
        ]
        offsets = []
        for opcode, group in groups:
            begin = summary.count
            for record in group:
                record.write(summary)
            if group:
                offsets.append(SummaryOffset(opcode, summary_start + begin, summary.count - begin))
        offset_start = summary_start + summary.count
        for offset in offsets:
            offset.write(summary)
        body = summary.end()
        # The checksum of the summary covers the footer up to the checksum itself.
        crc = zlib.crc32(body + struct.pack("<BQQQ", Opcode.FOOTER, 20, summary_start, offset_start))
        self._write(body)
        self._put(Footer(summary_start, offset_start, crc))
        self._write(MAGIC)

    def _statistics(self) -> Statistics:
        return Statistics(
            attachment_count=len(self._attachments),
            channel_count=len(self._channels),
            channel_message_counts=dict(self.counts),
            chunk_count=len(self._chunks),
            message_count=sum(self.counts.values()),
            message_end_time=self.end,
            message_start_time=self.start,
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )

    def _put(self, record: McapRecord) -> tuple[int, int]:
        builder = RecordBuilder()
        record.write(builder)
        data, offset = builder.end(), self._at
        self._write(data)
        return offset, len(data)

    def _write(self, data: bytes) -> None:
        self._stream.write(data)
        self._crc = zlib.crc32(data, self._crc)
        self._at += len(data)


def _message_index(channel: int, log_time: NDArray[np.int64], position: NDArray[np.int64]) -> bytes:
    table = np.stack([log_time, position], axis=1).astype("<u8").tobytes()
    return struct.pack("<BQHI", Opcode.MESSAGE_INDEX, 6 + len(table), channel, len(table)) + table
