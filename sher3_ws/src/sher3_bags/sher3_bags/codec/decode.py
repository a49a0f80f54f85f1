"""CDR messages to numpy columns.

As long as frame, joint names and array lengths stay the same, all messages of a topic have one layout, and a column is
a strided copy out of the buffer. Otherwise each message is decoded by itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_common.stamps import SECOND
from sher3_description import ACTUATORS

from sher3_bags.codec.cdr import STAMP, TEXT_START, Layout, read_layout
from sher3_bags.errors import MalformedMessageError
from sher3_bags.mcap import kernels
from sher3_bags.messages import TEXT, TYPES
from sher3_bags.run import Stream

_LITTLE_ENDIAN = 1


class Raw(NamedTuple):
    """The n messages buffer[offset:offset + length] of one topic."""

    topic: str
    type: str
    buffer: NDArray[np.uint8]
    offset: NDArray[np.int64]
    length: NDArray[np.int64]
    log_time: NDArray[np.int64]

    def layout(self, index: int) -> Layout:
        """Walk through one message."""
        start = self.offset[index]
        data = self.buffer[start : start + self.length[index]].tobytes()
        return read_layout(data, self.type, topic=self.topic, index=index)


def decode(raw: Raw) -> Stream:
    """Decode the messages of one topic, at least one, into columns.

    Raises:
        MalformedMessageError: a message does not decode, or frame, joints or array lengths change.
    """
    if raw.type == TEXT:
        return Stream(raw.type, raw.log_time, "", {"data": _texts(raw)}, raw.log_time)
    layout = raw.layout(0)
    if (raw.length == layout.length).all():
        constant = np.zeros(layout.length, np.uint8)
        for start, stop in layout.constant:
            constant[start:stop] = 255
        first = raw.buffer[raw.offset[0] : raw.offset[0] + layout.length]
        if kernels.first_difference(raw.buffer, raw.offset, first, constant) < 0:
            return _stream(raw, layout, *_values(raw.buffer, raw.offset, layout))
    return _decode_singly(raw)


def _texts(raw: Raw) -> tuple[str, ...]:
    """Decode strings: a count at byte 4, the text behind it, a zero byte at its end."""
    if (raw.length > TEXT_START).all():
        order = _gather(raw.buffer, raw.offset, 2, "u1")[:, 1]
        size = _gather(raw.buffer, raw.offset + 4, 1, "<u4")[:, 0].astype(np.int64)
        if (order == _LITTLE_ENDIAN).all() and ((size > 0) & (size <= raw.length - TEXT_START)).all():
            starts = raw.offset + TEXT_START
            data = raw.buffer.data
            spans = zip(starts.tolist(), (starts + size - 1).tolist(), strict=True)
            try:
                return tuple(str(data[start:stop], "utf-8") for start, stop in spans)
            except UnicodeDecodeError:
                pass  # the slow way names the message
    return tuple(raw.layout(index).text for index in range(len(raw.offset)))


def _values(
    buffer: NDArray[np.uint8], offset: NDArray[np.int64], layout: Layout
) -> tuple[NDArray[np.int64], dict[str, NDArray[Any]]]:
    """Return stamps and columns of messages that share a layout."""
    seconds = _gather(buffer, offset + STAMP, 1, layout.order + "i4")[:, 0].astype(np.int64)
    nanoseconds = _gather(buffer, offset + STAMP + 4, 1, layout.order + "u4")[:, 0]
    columns = {
        entry.name: _gather(buffer, offset + start, count, layout.order + entry.code)
        for entry, start, count in layout.slots
    }
    return seconds * SECOND + nanoseconds, columns


def _gather(buffer: NDArray[np.uint8], offset: NDArray[np.int64], count: int, dtype: str) -> NDArray[Any]:
    """Return `count` numbers at each offset as (n, count) in the machine's byte order."""
    values = np.empty((len(offset), count), dtype)
    if count:
        kernels.gather(buffer, offset, values.view(np.uint8))
    return values.astype(values.dtype.newbyteorder("="), copy=False)


def _decode_singly(raw: Raw) -> Stream:
    """Decode messages whose bytes differ in layout; they must still share frame, joints and array lengths."""
    first, stamps, parts = raw.layout(0), [], []
    for index in range(len(raw.offset)):
        layout = raw.layout(index)
        if layout.shape() != first.shape():
            raise MalformedMessageError(
                "frame, joints or array lengths change within the run",
                topic=raw.topic,
                index=index,
                value=layout.shape(),
                limit=first.shape(),
                remedy="split the recording where its publisher changed",
            )
        stamp, columns = _values(raw.buffer, raw.offset[index : index + 1], layout)
        stamps.append(stamp)
        parts.append(columns)
    joined = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return _stream(raw, first, np.concatenate(stamps), joined)


def _stream(raw: Raw, layout: Layout, stamp: NDArray[np.int64], columns: Mapping[str, NDArray[Any]]) -> Stream:
    kept = {name: column for name, column in columns.items() if column.shape[1]}
    kept = {name: column[:, 0] if _is_scalar(raw.type, name) else column for name, column in kept.items()}
    if TYPES[raw.type].names:
        _check_joints(raw.topic, kept)
        order = _joint_order(raw.topic, layout.names)
        if order is not None:
            kept = {name: np.ascontiguousarray(column[:, order]) for name, column in kept.items()}
    return Stream(raw.type, stamp, layout.frame_id, kept, raw.log_time)


def _is_scalar(type_name: str, name: str) -> bool:
    return any(f.name == name and f.count == 1 for f in TYPES[type_name].fields)


def _check_joints(topic: str, columns: Mapping[str, NDArray[Any]]) -> None:
    for name, column in columns.items():
        if column.shape[1] != len(ACTUATORS):
            raise MalformedMessageError(
                f"{name} has the wrong number of joints",
                topic=topic,
                index=0,
                value=column.shape[1],
                limit=len(ACTUATORS),
            )


def _joint_order(topic: str, names: tuple[str, ...]) -> list[int] | None:
    """Return the index in `names` of each actuator; None when no reordering is needed.

    No reordering is needed when the names are in the contract's order or when the message names no joints.
    """
    if names in ((), ACTUATORS):
        return None
    if sorted(names) != sorted(ACTUATORS):
        raise MalformedMessageError("unknown joints", topic=topic, index=0, value=names, limit=ACTUATORS)
    return [names.index(actuator) for actuator in ACTUATORS]
