"""CDR bytes of the messages that are made for viewers: transforms, joint states, lines and texts.

The layout is that of `codec.cdr`; field orders are those of ROS 2 Jazzy's definitions.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence

from sher3_common.stamps import SECOND

_STAMP = struct.Struct("<iI")
_TRANSFORM = struct.Struct("<7d")
LINE_LIST = 5
"""`Marker.LINE_LIST`: two points a line."""
LINE_COLOUR = (0.85, 0.86, 0.88, 1.0)
Triple = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


def text(content: str) -> bytes:
    """Return a `std_msgs/String`."""
    out = _begun()
    _string(out, content)
    return bytes(out)


def transforms(stamp: int, frames: Sequence[tuple[str, str, Triple, Quaternion]]) -> bytes:
    """Return a `TFMessage` of (parent, child, translation [m], rotation (x, y, z, w)) at a stamp [ns]."""
    out = _begun()
    out += struct.pack("<I", len(frames))
    for parent, child, translation, rotation in frames:
        _header(out, stamp, parent)
        _string(out, child)
        _align(out, 8)
        out += _TRANSFORM.pack(*translation, *rotation)
    return bytes(out)


def joint_state(stamp: int, names: Sequence[str], positions: Sequence[float]) -> bytes:
    """Return a `JointState` with positions alone at a stamp [ns]."""
    out = _begun()
    _header(out, stamp, "")
    _align(out, 4)
    out += struct.pack("<I", len(names))
    for name in names:
        _string(out, name)
    _align(out, 4)
    out += struct.pack("<I", len(positions))
    _align(out, 8)
    out += struct.pack(f"<{len(positions)}d", *positions)
    out += struct.pack("<II", 0, 0)
    return bytes(out)


def lines(stamp: int, frame: str, space: str, width: float, points: Sequence[Triple]) -> bytes:
    """Return a `Marker` of lines between every two points (2n, 3) [m], `width` [m] thick, at a stamp [ns]."""
    out = _begun()
    _header(out, stamp, frame)
    _string(out, space)
    _align(out, 4)
    out += struct.pack("<iii", 0, LINE_LIST, 0)
    _align(out, 8)
    out += struct.pack("<7d", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    out += struct.pack("<3d", width, 0.0, 0.0)
    out += struct.pack("<4f", *LINE_COLOUR)
    out += struct.pack("<iI?", 0, 0, False)
    _align(out, 4)
    out += struct.pack("<I", len(points))
    _align(out, 8)
    for point in points:
        out += struct.pack("<3d", *point)
    out += struct.pack("<I", 0)
    _string(out, "")  # texture
    _header(out, 0, "")
    _string(out, "")
    _align(out, 4)
    out += struct.pack("<I", 0)  # bytes of the texture
    _align(out, 4)
    out += struct.pack("<I", 0)  # uv coordinates
    _string(out, "")  # text
    _string(out, "")  # mesh
    _string(out, "")
    _align(out, 4)
    out += struct.pack("<I?", 0, False)
    return bytes(out)


def _begun() -> bytearray:
    return bytearray(b"\x00\x01\x00\x00")


def _header(out: bytearray, stamp: int, frame: str) -> None:
    _align(out, 4)
    out += _STAMP.pack(*divmod(stamp, SECOND))
    _string(out, frame)


def _string(out: bytearray, text: str) -> None:
    raw = text.encode() + b"\0"
    _align(out, 4)
    out += struct.pack("<I", len(raw)) + raw


def _align(out: bytearray, size: int) -> None:
    """Fill up to a multiple of a size, counted behind the four bytes of encapsulation."""
    out += bytes(-(len(out) - 4) % size)
