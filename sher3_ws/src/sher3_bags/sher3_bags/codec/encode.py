"""Numpy columns to CDR messages: one template with the stamps and values of every message written into it."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_common.stamps import SECOND
from sher3_description import ACTUATORS

from sher3_bags.codec.cdr import STAMP, read_layout
from sher3_bags.messages import TEXT, TYPES, Field
from sher3_bags.run import Stream


@dataclass(frozen=True)
class Encoded:
    """CDR messages one behind the other in `payload`."""

    payload: NDArray[np.uint8]
    start: NDArray[np.int64]
    length: NDArray[np.int64]


def encode(table: Stream) -> Encoded:
    """Encode a stream; joint names are the contract's."""
    if table.type == TEXT:
        return _encode_texts(table.data or ())
    kind = TYPES[table.type]
    columns = {f.name: _matrix(table.columns.get(f.name), len(table), f) for f in kind.fields}
    template = _template(table, {name: column.shape[1] for name, column in columns.items()})
    layout = read_layout(template, table.type)
    rows = np.tile(np.frombuffer(template, np.uint8), (len(table), 1))
    seconds, nanoseconds = np.divmod(table.stamp, SECOND)
    rows[:, STAMP : STAMP + 4] = seconds.astype("<i4")[:, None].view(np.uint8)
    rows[:, STAMP + 4 : STAMP + 8] = nanoseconds.astype("<u4")[:, None].view(np.uint8)
    for entry, start, count in layout.slots:
        if count:
            rows[:, start : start + count * int(entry.code[1])] = columns[entry.name].view(np.uint8)
    size = rows.shape[1]
    return Encoded(rows.reshape(-1), np.arange(len(table)) * size, np.full(len(table), size, np.int64))


def _matrix(column: Any, n: int, entry: Field) -> NDArray[Any]:
    """Return a column as (n, k) in the field's number format.

    A column that is None becomes (n, 0), or zeros where the type fixes k.
    """
    if column is None:
        return np.zeros((n, entry.count or 0), dtype="<" + entry.code)
    return np.ascontiguousarray(np.asarray(column).reshape(n, -1), dtype="<" + entry.code)


def _template(table: Stream, counts: Mapping[str, int]) -> bytes:
    kind = TYPES[table.type]
    out = bytearray(b"\x00\x01\x00\x00" + bytes(8) + _string(table.frame_id))
    if kind.names:
        _pad(out, 4)
        out += struct.pack("<I", len(ACTUATORS))
        for name in ACTUATORS:
            _pad(out, 4)
            out += _string(name)
    for entry in kind.fields:
        if entry.count is None:
            _pad(out, 4)
            out += struct.pack("<I", counts[entry.name])
        if counts[entry.name]:
            _pad(out, int(entry.code[1]))
            out += bytes(counts[entry.name] * int(entry.code[1]))
    return bytes(out)


def _pad(out: bytearray, size: int) -> None:
    out += bytes(-(len(out) - 4) % size)


def _string(text: str) -> bytes:
    raw = text.encode() + b"\0"
    return struct.pack("<I", len(raw)) + raw


def _encode_texts(texts: Sequence[str]) -> Encoded:
    messages = [b"\x00\x01\x00\x00" + _string(text) for text in texts]
    length = np.array([len(m) for m in messages], np.int64)
    return Encoded(np.frombuffer(b"".join(messages), np.uint8), np.cumsum(length) - length, length)
