"""CAN frames as bytes: the 16-byte `struct can_frame` of Linux, many of them end to end in one `bytes`.

The cyclic path builds no message object. At 1 kHz with 16 frames a cycle the objects alone would cost more than the
whole exchange (docs/reference/can.md).

Layout (include/uapi/linux/can.h, little-endian hosts): u32 can_id with flags in bits 29 to 31, u8 length, 3 bytes of
padding, 8 bytes of data. Frames of several channels that travel together are a *bundle*. They carry the number of
their channel in the first byte of the padding, which nothing else reads; elsewhere that byte is zero.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from sher3_drivers.errors import FrameError

FRAME_SIZE = 16
"""Bytes of one frame."""
EXTENDED_FLAG = 0x80000000
REMOTE_FLAG = 0x40000000
ERROR_FLAG = 0x20000000
ID_MASK = 0x1FFFFFFF
"""Bits of `can_id` that hold an extended identifier; a standard one takes the lower 11 of them."""
_STANDARD_IDS = 0x7FF
_WORD = 0xFFFFFFFF
_DATA_BYTES = 8
"""Data of a classic CAN frame at most (ISO 11898-1)."""

HEADER_FORMAT = "IBB2x"
"""Struct format of the eight bytes before the data: can_id, length, channel."""

BUNDLED = struct.Struct(f"<{HEADER_FORMAT}8s")
"""A frame of a bundle: can_id, length, channel, data with its padding."""

_FRAME = struct.Struct("<IB3x8s")
_CHANNEL = 5
"""Place of the channel number in a frame of a bundle."""


class Frame(NamedTuple):
    """One frame.

    Attributes:
        can_id: identifier with its flag bits.
        data: 0 to 8 bytes.
    """

    can_id: int
    data: bytes


def pack_frame(can_id: int, data: bytes = b"") -> bytes:
    """Return one 16-byte frame.

    Raises:
        FrameError: the data is longer than 8 bytes, or the identifier does not fit.
    """
    if len(data) > _DATA_BYTES:
        raise FrameError(
            "a classic CAN frame carries at most 8 bytes", value=len(data), limit=_DATA_BYTES, remedy="split the data"
        )
    standard = not can_id & (EXTENDED_FLAG | ERROR_FLAG)
    if not 0 <= can_id <= _WORD or (standard and can_id & ID_MASK > _STANDARD_IDS):
        raise FrameError(
            "the identifier does not fit a standard frame", value=hex(can_id), limit="0x7ff", remedy="set EXTENDED_FLAG"
        )
    return _FRAME.pack(can_id, len(data), data)


def pack_frames(frames: Iterable[Frame]) -> bytes:
    """Return the frames end to end, 16 bytes each."""
    return b"".join(pack_frame(*frame) for frame in frames)


def iter_frames(frames: bytes) -> Iterator[Frame]:
    """Yield every frame.

    Raises:
        FrameError: the bytes are no whole number of frames, or a length field exceeds 8.
    """
    check_frames(frames)
    for can_id, length, data in _FRAME.iter_unpack(frames):
        if length > _DATA_BYTES:
            raise FrameError(
                "a frame says it is longer than 8 bytes", value=length, limit=_DATA_BYTES, remedy="discard the frame"
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
    """Return a bundle of `parts[i]`, the frames of channel i.

    Raises:
        FrameError: a part is no whole number of frames.
    """
    for part in parts:
        check_frames(part)
    return b"".join([mark(part, channel) for channel, part in enumerate(parts) if part])


def channels_of(frames: bytes) -> bytes:
    """Return the channel of every frame of a bundle, one byte each."""
    return frames[_CHANNEL::FRAME_SIZE]


def unbundle(frames: bytes, count: int) -> list[bytes]:
    """Return the frames of channels 0 to `count` - 1 apart, in order and without their mark; others are left out.

    Raises:
        FrameError: the bundle is no whole number of frames.
    """
    check_frames(frames)
    channels = channels_of(frames)
    return [_of_channel(frames, channels, channel) for channel in range(count)]


def _of_channel(frames: bytes, channels: bytes, channel: int) -> bytes:
    """Return the frames of one channel without their mark; `channels` is that of every frame."""
    first, number = channels.find(channel), channels.count(channel)
    if channels[first : first + number] == bytes((channel,)) * number:  # nearly always they follow each other
        part = frames[FRAME_SIZE * first : FRAME_SIZE * (first + number)]
    else:
        places = [FRAME_SIZE * place for place, other in enumerate(channels) if other == channel]
        part = b"".join([frames[start : start + FRAME_SIZE] for start in places])
    return mark(part, 0) if part and channel else part
