"""Recover a cut or corrupt bag: every whole chunk is kept, and what is lost is counted."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mcap.opcode import Opcode
from sher3_common import make_folder
from sher3_description import NAMESPACE, TOPICS, Qos

from sher3_bags.contents import load, parse
from sher3_bags.errors import BagError, DamagedBagError
from sher3_bags.mcap.contents import Contents
from sher3_bags.mcap.file import Body, body_of, check_data, read_bytes, records
from sher3_bags.mcap.rosbag2 import TopicCount, find_mcap, write_metadata
from sher3_bags.mcap.writer import McapWriter
from sher3_bags.writing import write_chunks

RECOVERY_RECORD = "sher3.recovery"


@dataclass(frozen=True)
class Recovery:
    """The result of a recovery.

    Attributes:
        source: The damaged file.
        target: The folder written; None when the file was whole.
        messages: Number of recovered messages by absolute topic name.
        chunks: Number of recovered chunks.
        lost_chunks: Chunks inside the readable part that failed their checksum or did not decompress.
        lost_messages: Messages of a channel whose description is lost.
        lost_bytes: Bytes behind the first break.
        cause: What is wrong with the file; None when nothing is.
    """

    source: str
    target: str | None
    messages: dict[str, int]
    chunks: int
    lost_chunks: int
    lost_messages: int
    lost_bytes: int
    cause: str | None

    def __str__(self) -> str:
        if self.cause is None:
            return f"{self.source}: whole, {sum(self.messages.values())} messages in {self.chunks} chunks"
        return (
            f"{self.source}: {self.cause}\n"
            f"recovered {sum(self.messages.values())} messages in {self.chunks} chunks to {self.target}; "
            f"lost {self.lost_chunks} chunks inside, {self.lost_messages} messages without a channel, "
            f"{self.lost_bytes} bytes at the end"
        )


def recover(path: str | Path, target: str | Path | None = None) -> Recovery:
    """Write what can be read of a bag to a new rosbag2 folder, by default beside it as `<name>_recovered`.

    A whole bag is left alone: nothing is written.

    Raises:
        ForeignBagError: it is no MCAP file at all.
        BagError: nothing can be recovered, or the target exists.
    """
    mcap = find_mcap(Path(path))
    contents, lost_chunks, lost_bytes, cause = _salvage(mcap)
    lost_messages = _drop_unknown(contents)
    if lost_messages and cause is None:
        cause = "messages belong to a channel the file does not declare"
    names = {key: channel.topic for key, channel in contents.channels.items()}
    found, counts = np.unique(contents.messages.channel, return_counts=True)
    messages = {names[int(key)]: int(count) for key, count in zip(found, counts, strict=True)}
    folder = None
    if cause is not None:
        if not messages:
            raise BagError(f"nothing to recover: {cause}", path=mcap, remedy="record again")
        folder = Path(target) if target is not None else _beside(Path(path))
        _write(contents, folder, cause, messages)
    written = None if folder is None else str(folder)
    return Recovery(str(mcap), written, messages, contents.chunks, lost_chunks, lost_messages, lost_bytes, cause)


def _beside(path: Path) -> Path:
    return path.with_name(f"{path.stem if path.is_file() else path.name}_recovered")


def _salvage(mcap: Path) -> tuple[Contents, int, int, str | None]:
    """Return what can be read, the number of chunks that cannot, the bytes behind the first break, and its cause."""
    contents, bodies, causes = Contents(mcap), [], []
    data = read_bytes(mcap)
    end = len(data)
    chunks = 0
    try:
        for record in records(mcap, data):
            chunks += record.opcode == Opcode.CHUNK
            try:
                body = body_of(mcap, data, record)
                if body is not None:
                    bodies.append(body)
                    contents.chunks += record.opcode == Opcode.CHUNK
                elif record.opcode == Opcode.DATA_END:
                    check_data(mcap, data, record)
                else:
                    parse(mcap, record, contents)
            except BagError as error:
                causes.append(error)
    except DamagedBagError as error:
        causes.append(error)
        end = error.offset
    broken: list[tuple[Body, BagError]] = []
    load(contents, bodies, lambda body, error: broken.append((body, error)))
    contents.chunks -= sum(data[body.offset] == Opcode.CHUNK for body, _ in broken)
    cause = next((str(error.args[0]) for error in [*(error for _, error in broken), *causes]), None)
    return contents, chunks - contents.chunks, len(data) - end, cause


def _drop_unknown(contents: Contents) -> int:
    known = np.isin(contents.messages.channel, list(contents.channels))
    contents.messages = contents.messages.take(known)
    return int((~known).sum())


def _write(contents: Contents, folder: Path, cause: str, messages: dict[str, int]) -> None:
    if folder.exists():
        raise BagError("exists already", path=folder, remedy="choose another name")
    make_folder(folder)
    with (folder / f"{folder.name}.mcap").open("xb") as file:
        writer = McapWriter(file)
        for name, entries in contents.metadata.items():
            writer.add_metadata(name, entries)
        writer.add_metadata(RECOVERY_RECORD, {"source": contents.path.name, "cause": cause})
        for name, attachment in contents.attachments.items():
            writer.add_attachment(name, "application/octet-stream", attachment)
        for channel in contents.channels.values():
            writer.adopt(channel, contents.schemas.get(channel.schema_id))
        write_chunks(writer, contents.buffer, contents.messages)
        writer.close()
    topics = {}
    for channel in contents.channels.values():
        schema = contents.schemas.get(channel.schema_id)
        short = channel.topic.removeprefix(NAMESPACE + "/")
        qos = TOPICS[short].qos if short in TOPICS else Qos()
        topics[channel.topic] = TopicCount(schema.name if schema else "", messages.get(channel.topic, 0), qos)
    write_metadata(folder, f"{folder.name}.mcap", writer.start, writer.end, topics)
