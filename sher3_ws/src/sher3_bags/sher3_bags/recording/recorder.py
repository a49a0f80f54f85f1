"""Record raw CDR messages into a rosbag2 folder; plain code that is told the time.

A chunk is written in one piece as soon as it is full or old. Whatever happens to the process afterwards, the file lacks
at most the samples of one chunk (`CHUNK_LIMIT` bytes, `MAX_AGE_NS`).
"""

from __future__ import annotations

import json
import os
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType

import numpy as np
from sher3_common import make_folder
from sher3_common.stamps import SECOND
from sher3_description import TOPICS, Robot, Topic

from sher3_bags.codec.cdr import STAMP
from sher3_bags.errors import BagError, TopicError
from sher3_bags.figures.gaps import GapCounter, grid_periods, is_stamped
from sher3_bags.mcap.kernels import MESSAGE, MESSAGE_HEAD, RECORD_HEAD
from sher3_bags.mcap.rosbag2 import TopicCount, write_metadata
from sher3_bags.mcap.writer import CHUNK_LIMIT, McapWriter
from sher3_bags.provenance import PROVENANCE_RECORD, provenance
from sher3_bags.reading import ROBOT_FILE, RUN_RECORD
from sher3_bags.recording.beside import FOLLOWED, Beside
from sher3_bags.recording.made import Made
from sher3_bags.run import RunMetadata

RECORDING_RECORD = "sher3.recording"
MAX_AGE_NS = 500_000_000

_pack_head = struct.Struct("<BQHIQQ").pack
_unpack_stamp = struct.Struct("<iI").unpack_from
_LEAST = STAMP + 8
"""Bytes of the shortest message with a stamp."""


@dataclass(slots=True)
class _Source:
    topic: Topic
    channel: int
    gaps: GapCounter
    stamped: bool
    beside: Beside | None
    sequence: int = 0


@dataclass(slots=True)
class _MadeSource:
    first: Made
    channel: int
    count: int = 0


@dataclass(slots=True)
class _OpenChunk:
    body: bytearray = field(default_factory=bytearray)
    channel: list[int] = field(default_factory=list)
    log_time: list[int] = field(default_factory=list)
    position: list[int] = field(default_factory=list)


class Recorder:
    """Writes the bag `folder`, a new rosbag2 folder; a context manager.

    Args:
        folder: must not exist yet.
        robot: in force; attached to the bag, and the source of the sample periods.
        metadata: the contract's `sher3.run` record.
        parameters: settings of the nodes, noted in the provenance.
        beside: makes what viewers need beside the streams; None leaves it out.

    Raises:
        FileError: the folder exists (BagError) or cannot be made.
    """

    def __init__(
        self,
        folder: Path,
        robot: Robot,
        metadata: RunMetadata | None = None,
        parameters: Mapping[str, object] | None = None,
        beside: Beside | None = None,
    ) -> None:
        if folder.exists():
            raise BagError("exists already", path=folder, remedy="choose another name")
        make_folder(folder)
        self.folder = folder
        self._file = (folder / f"{folder.name}.mcap").open("xb")
        self._writer = McapWriter(self._file)
        self._writer.add_metadata(RUN_RECORD, (metadata or RunMetadata(origin="robot")).to_record())
        self._writer.add_metadata(PROVENANCE_RECORD, provenance(robot, parameters))
        self._writer.add_attachment(ROBOT_FILE, "application/yaml", robot.to_yaml().encode())
        self._periods = grid_periods(robot)
        self._sources: dict[str, _Source] = {}
        self._beside = beside
        self._made: dict[str, _MadeSource] = {}
        self._chunk = _OpenChunk()
        self.closed = False
        self._file.flush()

    def fileno(self) -> int:
        """Return the descriptor of the open file, by which its disk can be watched."""
        return self._file.fileno()

    def write(self, topic: str, data: bytes, log_time: int, publish_time: int | None = None) -> None:
        """Record one message.

        Args:
            topic: name in the topic table.
            data: the CDR bytes.
            log_time: ns at which it was received.
            publish_time: ns at which it was sent, where known.

        Raises:
            TopicError: the topic is not in the table.
            BagError: the recorder is closed, or the disk does not take the chunk.
        """
        if self.closed:
            raise BagError("the recording is complete", path=self.folder, remedy="start another one")
        source = self._sources.get(topic)
        if source is None:
            source = self._add(topic, log_time)
        if source.stamped and len(data) >= _LEAST:
            seconds, nanoseconds = _unpack_stamp(data, STAMP)
            source.gaps.see(seconds * SECOND + nanoseconds)
        else:
            source.gaps.see(log_time)
        sent = log_time if publish_time is None else publish_time
        self._append(source.channel, source.sequence, data, log_time, sent)
        source.sequence = (source.sequence + 1) & 0xFFFFFFFF
        if source.beside is not None:
            for message in source.beside.follow(topic, data, log_time):
                self._add_made(message, log_time)

    def _add_made(self, message: Made, log_time: int) -> None:
        """Record a message that was made beside the streams."""
        known = self._made.get(message.topic)
        if known is None:
            channel = self._writer.channel(message.topic, message.type, message.qos)
            known = self._made[message.topic] = _MadeSource(message, channel)
        self._append(known.channel, known.count, message.data, log_time, log_time)
        known.count += 1

    def _append(self, channel: int, sequence: int, data: bytes, log_time: int, sent: int) -> None:
        chunk = self._chunk
        body, size, begin = chunk.body, MESSAGE_HEAD + len(data), len(chunk.body)
        if begin and (begin + RECORD_HEAD + size > CHUNK_LIMIT or log_time - chunk.log_time[0] > MAX_AGE_NS):
            self.flush()
            chunk = self._chunk
            body, begin = chunk.body, 0
        chunk.channel.append(channel)
        chunk.log_time.append(log_time)
        chunk.position.append(begin)
        body += _pack_head(MESSAGE, size, channel, sequence, log_time, sent)
        body += data

    def flush(self) -> None:
        """Write what has been recorded so far to the file.

        Raises:
            BagError: the disk does not take it; what was written before can be recovered.
        """
        chunk, self._chunk = self._chunk, _OpenChunk()
        if not chunk.body:
            return
        try:
            self._writer.add_chunk(
                bytes(chunk.body), np.array(chunk.channel), np.array(chunk.log_time), np.array(chunk.position)
            )
            self._file.flush()
        except OSError as error:
            raise self._unwritable(error) from error

    def _unwritable(self, error: OSError) -> BagError:
        remedy = "free some space; `sher3 recover` saves what was written before"
        return BagError(f"cannot be written: {error.strerror}", path=self.folder, remedy=remedy)

    def counts(self) -> dict[str, dict[str, int]]:
        """Return messages, dropped samples, pauses and disorder per topic so far."""
        return {name: source.gaps.counts() for name, source in self._sources.items()}

    def close(self) -> dict[str, dict[str, int]]:
        """Complete the bag; return the counts per topic, which are also in the bag as `sher3.recording`.

        Raises:
            BagError: the disk does not take it.
        """
        counts = self.counts()
        if self.closed:
            return counts
        self.closed = True
        self.flush()
        try:
            self._writer.add_metadata(RECORDING_RECORD, {name: json.dumps(entry) for name, entry in counts.items()})
            self._writer.close()
            os.fsync(self._file.fileno())
            self._file.close()
        except OSError as error:
            raise self._unwritable(error) from error
        topics = {
            source.topic.recorded_name: TopicCount(source.topic.type, source.gaps.messages, source.topic.qos)
            for source in self._sources.values()
        }
        for name, made in self._made.items():
            topics[name] = TopicCount(made.first.type, made.count, made.first.qos)
        write_metadata(self.folder, f"{self.folder.name}.mcap", self._writer.start, self._writer.end, topics)
        return counts

    def _add(self, name: str, log_time: int) -> _Source:
        if name not in TOPICS:
            raise TopicError("no such topic in the table", topic=name, remedy="use a name relative to /sher3")
        topic = TOPICS[name]
        channel = self._writer.channel(topic.recorded_name, topic.type, topic.qos)
        gaps = GapCounter(self._periods.get(name), is_stamped(name))
        source = _Source(topic, channel, gaps, gaps.stamped, self._beside if name in FOLLOWED else None)
        if self._beside is not None and not self._made:
            for message in self._beside.fixed(log_time):
                self._add_made(message, log_time)
        self._sources[name] = source
        return source

    def __enter__(self) -> Recorder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
