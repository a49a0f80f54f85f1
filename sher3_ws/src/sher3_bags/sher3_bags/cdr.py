"""CDR messages to numpy columns, for the types of `messages.TYPES`.

CDR (OMG RTPS 2.5, section 10; XCDR version 1): four bytes of encapsulation, then every value aligned to its own size
counted from there; strings carry a length and end in a zero byte, sequences carry a count.
Messages of one topic have one layout as long as frame, joint names and array lengths stay the same: then columns are
strided copies. Otherwise each message is decoded on its own.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_description import ACTUATORS

from sher3_bags import kernels
from sher3_bags.errors import MalformedMessageError
from sher3_bags.messages import TEXT, TYPES, Field
from sher3_bags.run import Stream

Bytes = NDArray[np.uint8]
_ORDER = {b"\x00\x01": "<", b"\x00\x00": ">"}
STAMP = 4
"""Where the stamp of a message with a header starts: int32 s, uint32 ns."""


@dataclass
class Layout:
    """Where the values of one message lie; messages that share a layout agree in the `constant` spans."""

    order: str
    length: int
    frame_id: str = ""
    names: tuple[str, ...] = ()
    text: str = ""
    slots: list[tuple[Field, int, int]] = field(default_factory=list)
    constant: list[tuple[int, int]] = field(default_factory=list)

    def shape(self) -> tuple[Any, ...]:
        """Return what two messages must share to lie in the same columns, whatever their bytes."""
        return self.frame_id, self.names, tuple((f.name, count) for f, _, count in self.slots)


class _Cursor:
    def __init__(self, data: bytes, layout: Layout) -> None:
        self.data, self.layout, self.at = data, layout, 4

    def align(self, size: int) -> None:
        self.at += -(self.at - 4) % size

    def count(self) -> int:
        self.align(4)
        (value,) = struct.unpack_from(self.layout.order + "I", self.data, self.at)
        if value > len(self.data):
            raise struct.error(f"a count of {value} in a message of {len(self.data)} bytes")
        self.layout.constant.append((self.at, self.at + 4))
        self.at += 4
        return int(value)

    def string(self) -> str:
        size = self.count()
        raw = self.data[self.at : self.at + size]
        if len(raw) != size:
            raise struct.error(f"a string of {size} bytes where {len(raw)} are left")
        self.layout.constant.append((self.at, self.at + size))
        self.at += size
        return raw.rstrip(b"\0").decode("utf-8")

    def numbers(self, entry: Field) -> None:
        size = int(entry.code[1])
        count = self.count() if entry.count is None else entry.count
        if count:
            self.align(size)
        if self.at + count * size > len(self.data):
            raise struct.error(f"{count} numbers of {size} bytes where {len(self.data) - self.at} bytes are left")
        self.layout.slots.append((entry, self.at, count))
        self.at += count * size


def read_layout(data: bytes, type_name: str, *, topic: str = "", index: int | None = None) -> Layout:
    """Walk through one message.

    Raises:
        MalformedMessageError: the bytes are not such a message.
    """
    kind = TYPES[type_name]
    order = _ORDER.get(data[:2])
    try:
        if order is None:
            raise struct.error(f"encapsulation {data[:2].hex() or 'missing'}")
        layout = Layout(order, len(data), constant=[(0, 2)])
        cursor = _Cursor(data, layout)
        if kind.header:
            struct.unpack_from("<ii", data, STAMP)
            cursor.at += 8
            layout.frame_id = cursor.string()
        if kind.names:
            layout.names = tuple(cursor.string() for _ in range(cursor.count()))
        if type_name == TEXT:
            layout.text = cursor.string()
        for entry in kind.fields:
            cursor.numbers(entry)
    except (struct.error, UnicodeDecodeError) as error:
        raise MalformedMessageError(
            f"not a {type_name} in CDR: {error}", topic=topic, index=index, value=f"{len(data)} bytes"
        ) from error
    return layout


def decode(
    topic: str,
    type_name: str,
    buffer: Bytes,
    offset: NDArray[np.int64],
    length: NDArray[np.int64],
    log_time: NDArray[np.int64],
) -> Stream:
    """Decode the messages buffer[offset:offset + length] of one topic into columns.

    Raises:
        MalformedMessageError: a message does not decode, or frame, joints or array lengths change.
    """
    if type_name == TEXT:
        texts = [
            read_layout(_message(buffer, o, n), type_name, topic=topic, index=i).text
            for i, (o, n) in enumerate(zip(offset, length, strict=True))
        ]
        return Stream(type_name, log_time, "", {"data": tuple(texts)}, log_time)
    layout = read_layout(_message(buffer, offset[0], length[0]), type_name, topic=topic, index=0)
    if (length == layout.length).all():
        constant = np.zeros(layout.length, np.uint8)
        for start, stop in layout.constant:
            constant[start:stop] = 255
        first = buffer[offset[0] : offset[0] + layout.length]
        if kernels.first_difference(buffer, offset, first, constant) < 0:
            return _assemble(topic, type_name, layout, *_values(buffer, offset, layout), log_time)
    return _decode_singly(topic, type_name, buffer, offset, length, log_time)


def _message(buffer: Bytes, offset: int, length: int) -> bytes:
    return buffer[offset : offset + length].tobytes()


def _values(
    buffer: Bytes, offset: NDArray[np.int64], layout: Layout
) -> tuple[NDArray[np.int64], dict[str, NDArray[Any]]]:
    """Return stamps and columns of messages that share a layout."""
    seconds = _gather(buffer, offset + STAMP, 1, layout.order + "i4")[:, 0].astype(np.int64)
    nanoseconds = _gather(buffer, offset + STAMP + 4, 1, layout.order + "u4")[:, 0]
    columns = {
        entry.name: _gather(buffer, offset + start, count, layout.order + entry.code)
        for entry, start, count in layout.slots
    }
    return seconds * 1_000_000_000 + nanoseconds, columns


def _gather(buffer: Bytes, offset: NDArray[np.int64], count: int, dtype: str) -> NDArray[Any]:
    """Return `count` numbers at each offset as (n, count) in the machine's byte order."""
    values = np.empty((len(offset), count), dtype)
    kernels.gather(buffer, offset, values.view(np.uint8).reshape(len(offset), -1) if count else values.view(np.uint8))
    return values.astype(values.dtype.newbyteorder("="), copy=False)


def _decode_singly(
    topic: str,
    type_name: str,
    buffer: Bytes,
    offset: NDArray[np.int64],
    length: NDArray[np.int64],
    log_time: NDArray[np.int64],
) -> Stream:
    """Decode messages whose bytes differ in layout; they must still share frame, joints and array lengths."""
    layouts: list[Layout] = []
    stamps, parts = [], []
    for index, (start, size) in enumerate(zip(offset, length, strict=True)):
        layout = read_layout(_message(buffer, start, size), type_name, topic=topic, index=index)
        if layouts and layout.shape() != layouts[0].shape():
            raise MalformedMessageError(
                "frame, joints or array lengths change within the run",
                topic=topic,
                index=index,
                value=layout.shape(),
                limit=layouts[0].shape(),
                remedy="split the recording where its publisher changed",
            )
        layouts.append(layout)
        stamp, columns = _values(buffer, np.array([start]), layout)
        stamps.append(stamp)
        parts.append(columns)
    columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return _assemble(topic, type_name, layouts[0], np.concatenate(stamps), columns, log_time)


def _assemble(
    topic: str,
    type_name: str,
    layout: Layout,
    stamp: NDArray[np.int64],
    columns: Mapping[str, NDArray[Any]],
    log_time: NDArray[np.int64],
) -> Stream:
    kept = {name: column for name, column in columns.items() if column.shape[1]}
    kept = {name: column[:, 0] if _is_scalar(type_name, name) else column for name, column in kept.items()}
    if TYPES[type_name].names:
        _check_joints(topic, layout, kept)
        order = _joint_order(topic, layout.names)
        if order is not None:
            kept = {name: np.ascontiguousarray(column[:, order]) for name, column in kept.items()}
    return Stream(type_name, stamp, layout.frame_id, kept, log_time)


def _is_scalar(type_name: str, name: str) -> bool:
    return any(f.name == name and f.count == 1 for f in TYPES[type_name].fields)


def _check_joints(topic: str, layout: Layout, columns: Mapping[str, NDArray[Any]]) -> None:
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
    """Return where each actuator stands in `names`, or None when they stand in the contract's order or are unnamed."""
    if names in ((), ACTUATORS):
        return None
    if sorted(names) != sorted(ACTUATORS):
        raise MalformedMessageError("unknown joints", topic=topic, index=0, value=names, limit=ACTUATORS)
    return [names.index(actuator) for actuator in ACTUATORS]
