"""Write a `Run` as a bag, all topics at once."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from sher3_common import make_folder
from sher3_description import NAMESPACE, TOPICS, Qos

from sher3_bags.codec.encode import encode
from sher3_bags.errors import BagError
from sher3_bags.mcap import kernels
from sher3_bags.mcap.contents import Messages
from sher3_bags.mcap.rosbag2 import TopicCount, write_metadata
from sher3_bags.mcap.writer import CHUNK_LIMIT, McapWriter
from sher3_bags.reading import ROBOT_FILE, RUN_RECORD
from sher3_bags.run import Run


def write_run(path: str | Path, run: Run, *, namespace: str = NAMESPACE, overwrite: bool = False) -> Path:
    """Write a run as the rosbag2 folder `path`, or as one file where `path` ends in `.mcap`; return the path.

    Raises:
        BagError: something is there already and `overwrite` is false.
    """
    target = Path(path)
    if target.exists():
        if not overwrite:
            raise BagError("exists already", path=target, remedy="choose another name")
        shutil.rmtree(target) if target.is_dir() else target.unlink()
    alone = target.suffix == ".mcap"
    mcap = target if alone else target / f"{target.name}.mcap"
    make_folder(mcap.parent)
    with mcap.open("xb") as file:
        writer = McapWriter(file)
        writer.add_metadata(RUN_RECORD, run.metadata.to_record())
        for name, entries in run.records.items():
            writer.add_metadata(name, entries)
        if run.robot_yaml is not None:
            writer.add_attachment(ROBOT_FILE, "application/yaml", run.robot_yaml.encode(), run.start)
        counts = _write_streams(writer, run, namespace)
        writer.close()
    if not alone:
        write_metadata(target, mcap.name, writer.start, writer.end, counts)
    return target


def _write_streams(writer: McapWriter, run: Run, namespace: str) -> dict[str, TopicCount]:
    tables, payloads, base = [], [], 0
    counts: dict[str, TopicCount] = {}
    for topic, table in run.streams.items():
        n = len(table)
        if not n:
            continue
        name = f"{namespace.rstrip('/')}/{topic}"
        qos = TOPICS[topic].qos if topic in TOPICS else Qos()
        encoded = encode(table)
        channel = np.full(n, writer.channel(name, table.type, qos), np.uint16)
        log_time = table.stamp if table.log_time is None else table.log_time
        sequence = np.arange(n, dtype=np.uint32)
        tables.append(Messages(channel, sequence, log_time, table.stamp, encoded.start + base, encoded.length))
        payloads.append(encoded.payload)
        base += len(encoded.payload)
        counts[name] = TopicCount(table.type, n, qos)
    if tables:
        joined = Messages.joined(tables)
        # Topics of one tick keep the order in which the run names them.
        write_chunks(writer, np.concatenate(payloads), joined.take(np.argsort(joined.log_time, kind="stable")))
    return counts


def write_chunks(writer: McapWriter, payload: NDArray[np.uint8], messages: Messages) -> None:
    """Write messages, whose data lie in `payload`, as chunks of at most `CHUNK_LIMIT` bytes."""
    size = messages.length + (kernels.RECORD_HEAD + kernels.MESSAGE_HEAD)
    position = np.cumsum(size) - size
    out = np.empty(int(size.sum()), np.uint8)
    kernels.pack_messages(payload, *messages, position, out)
    first = 0
    for last in kernels.chunk_ends(size, CHUNK_LIMIT).tolist():
        begin, end = position[first], position[last - 1] + size[last - 1]
        part = slice(first, last)
        writer.add_chunk(out[begin:end].data, messages.channel[part], messages.log_time[part], position[part] - begin)
        first = last
