"""Field by field reading and writing of CDR, every bound checked; positions count from behind the encapsulation."""

from __future__ import annotations

import struct
from collections.abc import Iterable

MAX_STRING = 65_536
"""Longest string [bytes] that is read; no text on the topics comes near it."""

MAX_TRAILER = 24
"""Undefined bytes accepted behind the last field: rclpy reserves, and sends, a few for each empty sequence."""

_LENGTH = {order: struct.Struct(f"{order}I") for order in "<>"}
"""What stands before a string. Strings have a way of their own here: a report has sixty of them."""
_PADS = (b"", b"\0\0\0", b"\0\0", b"\0")
"""What aligns the next field to four bytes, by the length so far modulo four."""


class Reader:
    """Reads one message; raises ValueError or struct.error at the first violation."""

    def __init__(self, data: bytes) -> None:
        data = bytes(data)
        if len(data) < 4 or data[0] != 0 or data[1] not in (0, 1):
            raise ValueError(f"encapsulation header {data[:4].hex()} is not plain CDR")
        self._order = "<" if data[1] else ">"
        self._length = _LENGTH[self._order]
        self._data = data[4:]
        self._at = 0

    def _take(self, code: str, size: int, count: int = 1) -> tuple:
        start = self._at + -self._at % size
        if count < 0 or start + size * count > len(self._data):
            raise ValueError(f"{count} x {size} bytes at {start} exceed the {len(self._data)} there are")
        self._at = start + size * count
        return struct.unpack_from(f"{self._order}{count}{code}", self._data, start)

    def int32(self) -> int:
        """Read a signed 32-bit integer."""
        return self._take("i", 4)[0]

    def uint32(self) -> int:
        """Read an unsigned 32-bit integer."""
        return self._take("I", 4)[0]

    def byte(self) -> int:
        """Read one octet."""
        return self._take("B", 1)[0]

    def doubles(self, count: int) -> tuple[float, ...]:
        """Read `count` 64-bit floats."""
        return self._take("d", 8, count)

    def floats(self, count: int) -> tuple[float, ...]:
        """Read `count` 32-bit floats."""
        return self._take("f", 4, count)

    def integers(self, count: int) -> tuple[int, ...]:
        """Read `count` signed 32-bit integers."""
        return self._take("i", 4, count)

    def count(self, item_size: int) -> int:
        """Read the length of a sequence whose items need at least `item_size` bytes each."""
        count = self.uint32()
        if count * item_size > len(self._data) - self._at:
            raise ValueError(f"sequence of {count} items does not fit the rest of the message")
        return count

    def string(self) -> str:
        """Read a UTF-8 string."""
        data, begin = self._data, self._at + (-self._at & 3) + 4
        (length,) = self._length.unpack_from(data, begin - 4)
        end = begin + length
        if not 1 <= length <= MAX_STRING or end > len(data):
            raise ValueError(f"string of {length} bytes at {begin}")
        self._at = end
        if data[end - 1] != 0:
            raise ValueError("string without its NUL")
        return data[begin : end - 1].decode("utf-8")

    def finish(self) -> None:
        """Check that nothing follows but a trailer of at most `MAX_TRAILER` bytes."""
        if len(self._data) - self._at > MAX_TRAILER:
            raise ValueError(f"{len(self._data) - self._at} bytes too many")


class Writer:
    """Appends fields to `data` (without the encapsulation header), little endian."""

    def __init__(self) -> None:
        self.data = bytearray()

    def align(self, size: int) -> None:
        """Pad with zeros to a multiple of `size`."""
        self.data.extend(b"\0" * (-len(self.data) % size))

    def _put(self, code: str, size: int, *values: float) -> None:
        self.align(size)
        self.data.extend(struct.pack(f"<{len(values)}{code}", *values))

    def int32(self, value: int) -> None:
        """Append a signed 32-bit integer."""
        self._put("i", 4, value)

    def uint32(self, value: int) -> None:
        """Append an unsigned 32-bit integer."""
        self._put("I", 4, value)

    count = uint32

    def byte(self, value: int) -> None:
        """Append one octet."""
        self._put("B", 1, value)

    def floats(self, values: Iterable[float]) -> None:
        """Append a sequence of 32-bit floats."""
        values = tuple(values)
        self.count(len(values))
        self._put("f", 4, *values)

    def integers(self, values: Iterable[int]) -> None:
        """Append a sequence of signed 32-bit integers."""
        values = tuple(values)
        self.count(len(values))
        self._put("i", 4, *values)

    def string(self, text: str) -> None:
        """Append a UTF-8 string."""
        raw, data = text.encode("utf-8"), self.data
        length = len(raw) + 1
        if length > MAX_STRING or b"\0" in raw:
            raise ValueError(f"text of {length} bytes")
        data += _PADS[len(data) & 3] + _LENGTH["<"].pack(length) + raw + b"\0"
