"""Compiled loops over MCAP records: find messages, gather rows, pack messages into chunk bodies.

Record layout: https://mcap.dev/spec, `<opcode u8><length u64><content>`; a message's content is
`<channel u16><sequence u32><log_time u64><publish_time u64><data>`, little endian.
"""

from __future__ import annotations

import numpy as np
from sher3_common.compiled import compiled

RECORD_HEAD = 9
MESSAGE_HEAD = 22
MESSAGE = 0x05


@compiled(inline="always")
def _load(buffer, at, width):  # type: ignore[no-untyped-def]
    value = np.uint64(0)
    for k in range(width):
        value |= np.uint64(buffer[at + k]) << np.uint64(8 * k)
    return np.int64(value)


@compiled(inline="always")
def _store(buffer, at, width, value):  # type: ignore[no-untyped-def]
    word = np.uint64(value)
    for k in range(width):
        buffer[at + k] = np.uint8((word >> np.uint64(8 * k)) & np.uint64(255))


@compiled
def count_records(buffer):  # type: ignore[no-untyped-def]
    """Count messages and other records of a buffer.

    Returns:
        Number of messages, number of other records, and the first byte that belongs to no whole record, or -1.
    """
    messages = others = at = 0
    end = len(buffer)
    while at < end:
        if at + RECORD_HEAD > end:
            return messages, others, at
        length = _load(buffer, at + 1, 8)
        if length < 0 or length > end - at - RECORD_HEAD:
            return messages, others, at
        if buffer[at] == MESSAGE:
            if length < MESSAGE_HEAD:
                return messages, others, at
            messages += 1
        else:
            others += 1
        at += RECORD_HEAD + length
    return messages, others, -1


@compiled
def index_records(buffer, channel, sequence, log_time, publish_time, offset, length, other):  # type: ignore[no-untyped-def]
    """Fill the message table of a buffer that `count_records` accepts; `other` gets the other records."""
    m = k = at = 0
    while at < len(buffer):
        size = _load(buffer, at + 1, 8)
        if buffer[at] == MESSAGE:
            channel[m] = _load(buffer, at + 9, 2)
            sequence[m] = _load(buffer, at + 11, 4)
            log_time[m] = _load(buffer, at + 15, 8)
            publish_time[m] = _load(buffer, at + 23, 8)
            offset[m] = at + RECORD_HEAD + MESSAGE_HEAD
            length[m] = size - MESSAGE_HEAD
            m += 1
        else:
            other[k] = at
            k += 1
        at += RECORD_HEAD + size


@compiled
def first_difference(buffer, offset, first, constant):  # type: ignore[no-untyped-def]
    """Return the first message whose bytes differ from `first` where `constant` is 255; -1 if none does."""
    width = len(first)
    for i in range(len(offset)):
        # A view with a plain loop over it is what LLVM turns into vector code.
        message = buffer[offset[i] : offset[i] + width]
        differs = np.uint8(0)
        for j in range(width):
            differs |= (message[j] ^ first[j]) & constant[j]
        if differs:
            return i
    return -1


@compiled
def gather(buffer, offset, out):  # type: ignore[no-untyped-def]
    """Copy the bytes behind each offset into the rows of out (n, width)."""
    width = out.shape[1]
    for i in range(len(offset)):
        source, row = buffer[offset[i] : offset[i] + width], out[i]
        for j in range(width):
            row[j] = source[j]


@compiled
def chunk_ends(size, limit):  # type: ignore[no-untyped-def]
    """Divide records of the given sizes among chunks of at most `limit` bytes; return the end index of each chunk."""
    ends = np.empty(len(size), np.int64)
    n = filled = 0
    for i in range(len(size)):
        if filled and filled + size[i] > limit:
            ends[n] = i
            n += 1
            filled = 0
        filled += size[i]
    if filled:
        ends[n] = len(size)
        n += 1
    return ends[:n].copy()


@compiled
def pack_messages(payload, channel, sequence, log_time, publish_time, start, length, position, out):  # type: ignore[no-untyped-def]
    """Write message records to `out` at `position`, with data payload[start:start + length]."""
    for i in range(len(start)):
        at = position[i]
        out[at] = MESSAGE
        _store(out, at + 1, 8, length[i] + MESSAGE_HEAD)
        _store(out, at + 9, 2, channel[i])
        _store(out, at + 11, 4, sequence[i])
        _store(out, at + 15, 8, log_time[i])
        _store(out, at + 23, 8, publish_time[i])
        at += RECORD_HEAD + MESSAGE_HEAD
        source, target = payload[start[i] : start[i] + length[i]], out[at : at + length[i]]
        for j in range(len(source)):
            target[j] = source[j]
