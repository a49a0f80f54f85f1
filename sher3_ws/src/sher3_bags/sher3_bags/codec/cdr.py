"""The layout of CDR messages of the types of `messages.TYPES`.

CDR (OMG RTPS 2.5, section 10; XCDR version 1): four bytes of encapsulation, then every value aligned to its own size
counted from there; strings carry a length and end in a zero byte, sequences carry a count.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import Any

from sher3_bags.errors import MalformedMessageError
from sher3_bags.messages import TEXT, TYPES, Field

_ORDER = {b"\x00\x01": "<", b"\x00\x00": ">"}
STAMP = 4
"""Byte at which the stamp of a message with a header starts: int32 s, uint32 ns."""
TEXT_START = 8
"""Byte at which the text of a `std_msgs/String` starts: behind the encapsulation and the length, four bytes each."""


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
        """Return what two messages must have in common to lie in the same columns, whatever their bytes."""
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
