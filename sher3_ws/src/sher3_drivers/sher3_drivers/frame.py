"""CAN frames as bytes: the 16-byte `struct can_frame` of Linux, many of them end to end in one `bytes`.

The cyclic path never builds a message object: at 1 kHz with 16 frames a cycle the objects alone cost more than the
whole exchange (docs/can.md). Layout (include/uapi/linux/can.h, little-endian hosts): u32 can_id with flags in bits
29-31, u8 length, 3 bytes padding, 8 bytes data. Frames of several channels that travel together (a *bundle*) say their
channel in the first padding byte, which nothing else reads; on a channel of its own it is zero.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from .errors import FrameError

FRAME_SIZE = 16
EXTENDED_FLAG = 0x80000000
REMOTE_FLAG = 0x40000000
ERROR_FLAG = 0x20000000
ID_MASK = 0x1FFFFFFF

HEADER_FORMAT = "IBB2x"
"""Struct format of the eight bytes before the data: can_id, length, channel."""

BUNDLED = struct.Struct(f"<{HEADER_FORMAT}8s")
"""A frame of a bundle: can_id, length, channel, data with its padding."""

_FRAME = struct.Struct("<IB3x8s")
_CHANNEL = 5


class Frame(NamedTuple):
    """One frame: `can_id` with its flag bits, and `data` of 0 to 8 bytes."""

    can_id: int
    data: bytes


def pack_frame(can_id: int, data: bytes = b"") -> bytes:
    """Return one 16-byte frame; raise FrameError when the data is longer than 8 bytes or the id does not fit."""
    if len(data) > 8:
        raise FrameError(
            "a classic CAN frame carries at most 8 bytes", value=len(data), limit=8, remedy="split the data"
        )
    if not 0 <= can_id <= 0xFFFFFFFF or (not can_id & (EXTENDED_FLAG | ERROR_FLAG) and can_id & ID_MASK > 0x7FF):
        raise FrameError(
            "the identifier does not fit a standard frame", value=hex(can_id), limit="0x7ff", remedy="set EXTENDED_FLAG"
        )
    return _FRAME.pack(can_id, len(data), data)


def pack_frames(frames: Iterable[Frame]) -> bytes:
    """Return the frames end to end, 16 bytes each."""
    return b"".join(pack_frame(*frame) for frame in frames)


def iter_frames(frames: bytes) -> Iterator[Frame]:
    """Yield every frame; raise FrameError when the length is not a multiple of 16 or a length field exceeds 8."""
    check_frames(frames)
    for can_id, length, data in _FRAME.iter_unpack(frames):
        if length > 8:
            raise FrameError(
                "a frame says it is longer than 8 bytes", value=length, limit=8, remedy="discard the frame"
            )
        yield Frame(can_id, data[:length])


def check_frames(frames: bytes) -> None:
    """Raise FrameError unless `frames` is a whole number of frames."""
    if len(frames) % FRAME_SIZE:
        raise FrameError(
            "not a whole number of frames",
            value=len(frames),
            limit=f"a multiple of {FRAME_SIZE}",
            remedy="discard the bytes",
        )


def mark(frames: bytes, channel: int) -> bytes:
    """Return whole frames marked with their channel, 0 to 255."""
    marked = bytearray(frames)
    marked[_CHANNEL::FRAME_SIZE] = bytes((channel,)) * (len(frames) // FRAME_SIZE)
    return bytes(marked)


def bundle(parts: Sequence[bytes]) -> bytes:
    """Return `parts[i]`, the frames of channel i, end to end and marked with it; FrameError unless they are whole."""
    for part in parts:
        check_frames(part)
    return b"".join([mark(part, channel) for channel, part in enumerate(parts)])


def channels_of(frames: bytes) -> bytes:
    """Return the channel of every frame of a bundle, one byte each."""
    return frames[_CHANNEL::FRAME_SIZE]


def unbundle(frames: bytes, count: int) -> list[bytes]:
    """Return the frames of channels 0 to `count` - 1, in order and without the mark; frames of others are left out."""
    check_frames(frames)
    parts = [bytearray() for _ in range(count)]
    for start, channel in zip(range(0, len(frames), FRAME_SIZE), channels_of(frames), strict=True):
        if channel < count:
            parts[channel] += frames[start : start + FRAME_SIZE]
    for part in parts:
        part[_CHANNEL::FRAME_SIZE] = bytes(len(part) // FRAME_SIZE)
    return [bytes(part) for part in parts]
