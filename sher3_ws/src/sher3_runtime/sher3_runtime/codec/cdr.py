"""CDR codecs of the message types, in plain Python: a `struct` per layout, a full parse for everything else.

On a topic the frame and the joint names never change, so a message has a fixed layout: one `Struct.unpack` and a
comparison of its constant part decode it. The format is OMG DDS-XTypes 7.4.1, plain CDR, version 1: primitives are
aligned to their size, counted from behind the encapsulation header of four bytes; strings have a length and end in
NUL; sequences have a length. A message of another layout is parsed field by field, and every bound is checked.
Whatever does not fit raises `CdrError` and no other error; a message is decoded whole or not at all.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any, NamedTuple

from sher3_common.errors import Sher3Error
from sher3_common.samples import (
    DiagnosticSample,
    JointSample,
    JoySample,
    PoseSample,
    Sample,
    TemperatureSample,
    TextSample,
    TwistSample,
    WrenchSample,
)
from sher3_common.stamps import SECOND

from sher3_runtime.codec.fields import MAX_STRING, Reader, Writer

_LITTLE_ENDIAN = b"\x00\x01\x00\x00"


class CdrError(Sher3Error):
    """Bytes that are no valid message of their topic, or a sample that cannot be one."""


class Codec(NamedTuple):
    """`encode(sample) -> bytes` and `decode(bytes) -> sample` of one topic."""

    encode: Callable[[Any], bytes]
    decode: Callable[[bytes], Any]


def as_sent(type_name: str) -> Callable[[Any], Any] | None:
    """Return what makes of a sample the one that comes out at the other end; None where the two are the same.

    The axes of a Joy are 32-bit floats on the wire.
    """
    return _single_axes if type_name.endswith("/Joy") else None


def codec(type_name: str, frame_id: str = "", joints: tuple[str, ...] = ()) -> Codec:
    """Return the codec of a topic.

    Args:
        type_name: ROS interface as in `sensor_msgs/msg/JointState`.
        frame_id: the constant frame of the topic.
        joints: the constant joint names of a JointState topic.

    Raises:
        CdrError: a message type the project has no codec for.
    """
    name = type_name.rsplit("/", 1)[-1]
    if name == "JointState":
        return _joint_codec(frame_id, joints)
    if name in _DOUBLES:
        return _doubles_codec(frame_id, *_DOUBLES[name])
    if name == "Joy":
        return _joy_codec(frame_id)
    if name == "String":
        return Codec(_encode_text, _guarded_decode(_read_text, frame_id))
    if name in _VARIABLE:
        write, read = _VARIABLE[name]
        return Codec(_guarded_encode(write, frame_id), _guarded_decode(read, frame_id))
    known = ", ".join(["JointState", "Joy", "String", *_DOUBLES, *_VARIABLE])
    raise CdrError("no codec for this message type", value=type_name, limit=known, remedy="use one of these")


# Messages that are a header and a fixed number of doubles.

_DOUBLES: dict[str, tuple[int, Callable[..., Sample], Callable[[Any], tuple[float, ...]]]] = {
    "WrenchStamped": (6, lambda stamp, *v: WrenchSample(stamp, v), lambda s: s.wrench),
    "TwistStamped": (6, lambda stamp, *v: TwistSample(stamp, v), lambda s: s.twist),
    "PoseStamped": (7, lambda stamp, *v: PoseSample(stamp, v[:3], v[3:]), lambda s: (*s.position, *s.orientation)),
    "Temperature": (2, lambda stamp, t, _: TemperatureSample(stamp, t), lambda s: (s.temperature, 0.0)),
}


def _doubles_codec(
    frame_id: str, count: int, build: Callable[..., Sample], flatten: Callable[[Any], tuple[float, ...]]
) -> Codec:
    writer = Writer()
    writer.string(frame_id)
    blob = bytes(writer.data)
    # Header stamp (8 bytes) is a multiple of the alignment, so the blob's own alignment is that of the message.
    pad = -(len(blob)) % 8
    layout = struct.Struct(f"<4siI{len(blob)}s{pad}x{count}d")
    unpack, pack, size = layout.unpack, layout.pack, layout.size

    def decode(data: bytes) -> Any:
        if len(data) == size:
            kind, sec, nanosec, constant, *values = unpack(data)
            if kind == _LITTLE_ENDIAN and constant == blob and nanosec < SECOND:
                return build(sec * SECOND + nanosec, *values)
        return slow(data)

    def encode(sample: Any) -> bytes:
        sec, nanosec = divmod(sample.stamp, SECOND)
        try:
            return pack(_LITTLE_ENDIAN, sec, nanosec, blob, *flatten(sample))
        except (struct.error, TypeError) as error:
            raise _refusal(sample, error) from None

    slow = _guarded_decode(lambda r, frame: build(_header(r, frame), *r.doubles(count)), frame_id)
    return Codec(encode, decode)


# JointState: eight layouts, one for each combination of present fields.


def _joint_codec(frame_id: str, joints: tuple[str, ...]) -> Codec:
    writer = Writer()
    writer.string(frame_id)
    writer.count(len(joints))
    for joint in joints:
        writer.string(joint)
    writer.align(4)
    blob, n = bytes(writer.data), len(joints)
    layouts = {key: _joint_layout(len(blob), n, key) for key in range(8)}
    by_size: dict[int, list[tuple[struct.Struct, tuple[bool, bool, bool]]]] = {}
    for key, layout in layouts.items():
        by_size.setdefault(layout.size, []).append((layout, (bool(key & 1), bool(key & 2), bool(key & 4))))

    def decode(data: bytes) -> JointSample:
        for layout, present in by_size.get(len(data), ()):
            kind, sec, nanosec, constant, *rest = layout.unpack(data)
            if kind != _LITTLE_ENDIAN or constant != blob or nanosec >= SECOND:
                break
            fields: list[tuple[float, ...] | None] = []
            at = 0
            for here in present:
                if rest[at] != (n if here else 0):
                    break
                fields.append(tuple(rest[at + 1 : at + 1 + n]) if here else None)
                at += 1 + n if here else 1
            else:
                return JointSample(sec * SECOND + nanosec, *fields)
        return slow(data)

    def encode(sample: JointSample) -> bytes:
        stamp, position, velocity, effort = sample
        sec, nanosec = divmod(stamp, SECOND)
        key = 0
        values: list[float] = []
        for bit, field in ((1, position), (2, velocity), (4, effort)):
            if field is None:
                values.append(0)
            else:
                key |= bit
                values.append(n)
                values.extend(field)
        try:
            return layouts[key].pack(_LITTLE_ENDIAN, sec, nanosec, blob, *values)
        except (struct.error, TypeError) as error:
            raise _refusal(sample, error) from None

    def parse(reader: Reader, frame: str) -> JointSample:
        stamp = _header(reader, frame)
        names = tuple(reader.string() for _ in range(reader.count(5)))
        if sorted(names) != sorted(joints):
            given, wanted = ", ".join(names) or "none", ", ".join(joints)
            raise CdrError("joint names differ", value=given, limit=wanted, remedy="name all of them, in any order")
        order = [names.index(joint) for joint in joints]
        fields: list[Any] = []
        for label in ("position", "velocity", "effort"):
            count = reader.count(8)
            if count not in (0, n):
                raise CdrError(f"length of {label}", value=count, limit=f"0 or {n}", remedy="send all joints or none")
            values = reader.doubles(count) if count else None
            fields.append(None if values is None else tuple(values[k] for k in order))
        return JointSample(stamp, *fields)

    slow = _guarded_decode(parse, frame_id)
    return Codec(encode, decode)


def _joint_layout(blob: int, n: int, key: int) -> struct.Struct:
    text, offset = f"<4siI{blob}s", 8 + blob
    for bit in (1, 2, 4):
        text += "I"
        offset += 4
        if key & bit:
            pad = -offset % 8
            text += f"{pad}x{n}d"
            offset += pad + 8 * n
    return struct.Struct(text)


# Messages of variable length. A Joy of one axis and one button, our pedal, has a fast path.


def _joy_codec(frame_id: str) -> Codec:
    writer = Writer()
    writer.string(frame_id)
    writer.align(4)
    blob = bytes(writer.data)
    layout = struct.Struct(f"<4siI{len(blob)}sIfIi")
    unpack, size, slow = layout.unpack, layout.size, _guarded_decode(_read_joy, frame_id)

    def decode(data: bytes) -> JoySample:
        if len(data) == size:
            kind, sec, nanosec, constant, axes, travel, buttons, button = unpack(data)
            if kind == _LITTLE_ENDIAN and constant == blob and nanosec < SECOND and axes == buttons == 1:
                return JoySample(sec * SECOND + nanosec, (travel,), (button,))
        return slow(data)

    pack, slow_encode = layout.pack, _guarded_encode(_write_joy, frame_id)

    def encode(sample: JoySample) -> bytes:
        if len(sample.axes) == len(sample.buttons) == 1:
            try:
                sec, nanosec = divmod(sample.stamp, SECOND)
                return pack(_LITTLE_ENDIAN, sec, nanosec, blob, 1, sample.axes[0], 1, sample.buttons[0])
            except (struct.error, TypeError, OverflowError) as error:
                raise _refusal(sample, error) from None
        return slow_encode(sample)

    return Codec(encode, decode)


def _single_axes(sample: JoySample) -> JoySample:
    single = f"<{len(sample.axes)}f"
    try:
        return JoySample(sample.stamp, struct.unpack(single, struct.pack(single, *sample.axes)), sample.buttons)
    except (struct.error, TypeError, OverflowError) as error:
        raise _refusal(sample, error) from None


def _read_joy(reader: Reader, frame_id: str) -> JoySample:
    stamp = _header(reader, frame_id)
    axes = reader.floats(reader.count(4))
    return JoySample(stamp, axes, reader.integers(reader.count(4)))


def _write_joy(writer: Writer, frame_id: str, sample: JoySample) -> None:
    _write_header(writer, frame_id, sample.stamp)
    writer.floats(sample.axes)
    writer.integers(sample.buttons)


def _read_text(reader: Reader, _: str) -> TextSample:
    return TextSample(reader.string())


_TEXT_HEAD = struct.Struct("<4sI")


def _encode_text(sample: TextSample) -> bytes:
    try:
        raw = sample.text.encode("utf-8")
    except (AttributeError, UnicodeError) as error:
        raise _refusal(sample, error) from None
    if len(raw) >= MAX_STRING or b"\0" in raw:
        raise CdrError("text cannot be sent", value=f"{len(raw)} bytes", limit=f"{MAX_STRING} bytes and no NUL")
    return _TEXT_HEAD.pack(_LITTLE_ENDIAN, len(raw) + 1) + raw + b"\0"


def _read_diagnostic(reader: Reader, frame_id: str) -> DiagnosticSample:
    stamp = _header(reader, frame_id)
    if (statuses := reader.count(17)) != 1:
        raise CdrError("number of statuses in one message", value=statuses, limit=1, remedy="send one per message")
    level, name, message, _hardware = reader.byte(), reader.string(), reader.string(), reader.string()
    values = tuple((reader.string(), reader.string()) for _ in range(reader.count(10)))
    return DiagnosticSample(stamp, name, level, message, values)


def _write_diagnostic(writer: Writer, frame_id: str, sample: DiagnosticSample) -> None:
    _write_header(writer, frame_id, sample.stamp)
    writer.count(1)
    writer.byte(sample.level)
    for text in (sample.name, sample.message, "sher3"):
        writer.string(text)
    writer.count(len(sample.values))
    for key, value in sample.values:
        writer.string(key)
        writer.string(value)


_VARIABLE: dict[str, tuple[Callable[[Writer, str, Any], None], Callable[[Reader, str], Any]]] = {
    "DiagnosticArray": (_write_diagnostic, _read_diagnostic),
}


def _header(reader: Reader, frame_id: str) -> int:
    sec, nanosec, frame = reader.int32(), reader.uint32(), reader.string()
    if nanosec >= SECOND:
        raise CdrError("nanoseconds of the stamp", value=nanosec, limit=SECOND - 1, remedy="send a normalised stamp")
    if frame != frame_id:
        raise CdrError("frame_id", value=repr(frame), limit=repr(frame_id), remedy="send in the frame of the topic")
    return sec * SECOND + nanosec


def _write_header(writer: Writer, frame_id: str, stamp: int) -> None:
    sec, nanosec = divmod(stamp, SECOND)
    writer.int32(sec)
    writer.uint32(nanosec)
    writer.string(frame_id)


def _guarded_encode(write: Callable[[Writer, str, Any], None], frame_id: str) -> Callable[[Any], bytes]:
    def encode(sample: Any) -> bytes:
        writer = Writer()
        try:
            write(writer, frame_id, sample)
        except (struct.error, TypeError, ValueError, OverflowError) as error:
            raise _refusal(sample, error) from None
        return _LITTLE_ENDIAN + bytes(writer.data)

    return encode


def _guarded_decode(read: Callable[[Reader, str], Any], frame_id: str) -> Callable[[bytes], Any]:
    def decode(data: bytes) -> Any:
        try:
            reader = Reader(data)
            sample = read(reader, frame_id)
            reader.finish()
        except CdrError:
            raise
        except (struct.error, ValueError, OverflowError) as error:
            raise CdrError(
                f"no valid message: {error}", value=f"{len(data)} bytes", remedy="check the sender"
            ) from None
        return sample

    return decode


def _refusal(sample: Any, error: Exception) -> CdrError:
    return CdrError(f"cannot be sent: {error}", value=sample, remedy="give finite numbers and all components")
