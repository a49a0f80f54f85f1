"""CAN frames as bytes: the 16-byte `struct can_frame` of Linux, many of them end to end in one `bytes`.

The cyclic path never builds a message object: at 1 kHz with 16 frames a cycle the objects alone cost more than the
whole exchange (docs/can.md). Layout (include/uapi/linux/can.h, little-endian hosts): u32 can_id with flags in bits
29-31, u8 length, 3 bytes padding, 8 bytes data.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from .errors import FrameError

FRAME_SIZE = 16
EXTENDED_FLAG = 0x80000000
REMOTE_FLAG = 0x40000000
ERROR_FLAG = 0x20000000
ID_MASK = 0x1FFFFFFF

HEADER_FORMAT = "IB3x"
"""Struct format of the eight bytes before the data; followed by a data format it packs a whole frame in one call."""

_FRAME = struct.Struct("<IB3x8s")


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
