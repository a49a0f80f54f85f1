"""The message types of the contract: their ROS definitions and their fields in CDR order.

Definitions are the field lines of ROS 2 Jazzy's common_interfaces without comments.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path

from sher3_bags.errors import TopicError

DEFINITIONS: dict[str, str] = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id",
    "std_msgs/String": "string data",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Quaternion": "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1",
    "geometry_msgs/Pose": "Point position\nQuaternion orientation",
    "geometry_msgs/Twist": "Vector3  linear\nVector3  angular",
    "geometry_msgs/Wrench": "Vector3  force\nVector3  torque",
    "geometry_msgs/PoseStamped": "std_msgs/Header header\nPose pose",
    "geometry_msgs/TwistStamped": "std_msgs/Header header\nTwist twist",
    "geometry_msgs/WrenchStamped": "std_msgs/Header header\nWrench wrench",
    "sensor_msgs/JointState": (
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort"
    ),
    "sensor_msgs/Joy": "std_msgs/Header header\nfloat32[] axes\nint32[] buttons",
    "diagnostic_msgs/KeyValue": "string key\nstring value",
    "diagnostic_msgs/DiagnosticStatus": (
        "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n"
        "byte level\nstring name\nstring message\nstring hardware_id\nKeyValue[] values"
    ),
    "diagnostic_msgs/DiagnosticArray": "std_msgs/Header header\nDiagnosticStatus[] status",
    "geometry_msgs/Transform": "Vector3 translation\nQuaternion rotation",
    "geometry_msgs/TransformStamped": "std_msgs/Header header\nstring child_frame_id\nTransform transform",
    "builtin_interfaces/Duration": "int32 sec\nuint32 nanosec",
    "std_msgs/ColorRGBA": "float32 r\nfloat32 g\nfloat32 b\nfloat32 a",
    "sensor_msgs/CompressedImage": "std_msgs/Header header\nstring format\nuint8[] data",
    "visualization_msgs/UVCoordinate": "float32 u\nfloat32 v",
    "visualization_msgs/MeshFile": "string filename\nuint8[] data",
    "visualization_msgs/Marker": (
        "std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\ngeometry_msgs/Pose pose\n"
        "geometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\nbuiltin_interfaces/Duration lifetime\n"
        "bool frame_locked\ngeometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] colors\nstring texture_resource\n"
        "sensor_msgs/CompressedImage texture\nUVCoordinate[] uv_coordinates\nstring text\nstring mesh_resource\n"
        "MeshFile mesh_file\nbool mesh_use_embedded_materials"
    ),
    "tf2_msgs/TFMessage": "geometry_msgs/TransformStamped[] transforms",
    "crtk_msgs/OperatingState": "std_msgs/Header header\nstring state\nbool is_homed\nbool is_busy",
    "crtk_msgs/StringStamped": "std_msgs/Header header\nstring string",
    "sher3_msgs/Fault": "string code\nstring source\nfloat64 value\nfloat64 limit\nstring unit\nstring action",
    "sher3_msgs/Refusal": "string error\nstring text",
    "sher3_msgs/SupervisorStatus": (
        "std_msgs/Header header\nstring state\nbuiltin_interfaces/Time since\nstring reason\nstring action\n"
        "bool is_homed\nFault first_fault\nuint32 later_faults\nRefusal refused"
    ),
    "sher3_msgs/MotionStatus": (
        "std_msgs/Header header\nstring mode\nbuiltin_interfaces/Time since\nstring reason\nstring text\n"
        "string limited_by\nbool is_busy\nfloat64 rcm_deviation\nRefusal refused"
    ),
    "sher3_msgs/AdmittanceStatus": (
        "std_msgs/Header header\nstring reason\nstring text\nbuiltin_interfaces/Time since\nbool drift_exceeded\n"
        "Refusal refused"
    ),
    "sher3_msgs/AdmittanceTick": (
        "std_msgs/Header header\nint64 tick\nint64 wrench_stamp\nint64 pedal_stamp\nint64 joints_stamp\n"
        "bool enabled\nbool owner\nuint32 version"
    ),
    "sher3_msgs/MotionTick": (
        "std_msgs/Header header\nint64 tick\nint64 joints_stamp\nint64 twist_stamp\n"
        "bool enabled\nuint8 mode\nuint8 reason\nuint32 version"
    ),
    "sher3_msgs/Settings": (
        "std_msgs/Header header\nuint32 version\nstring regime\nbool has_remote_centre\n"
        "geometry_msgs/Point remote_centre\nstring[] names\nfloat64[] values"
    ),
    "sensor_msgs/Temperature": "std_msgs/Header header\nfloat64 temperature\nfloat64 variance",
}


@dataclass(frozen=True)
class Field:
    """One numeric field: numpy scalar code and the number of elements, None for a sequence."""

    name: str
    code: str
    count: int | None


@dataclass(frozen=True)
class MessageType:
    """How a type lies in CDR: a header, a list of names, then numeric fields; or one string."""

    fields: tuple[Field, ...]
    header: bool = True
    names: bool = False


def _f8(*names: str, count: int | None = 3) -> tuple[Field, ...]:
    return tuple(Field(name, "f8", count) for name in names)


TEXT = "std_msgs/msg/String"
TYPES: dict[str, MessageType] = {
    "sensor_msgs/msg/JointState": MessageType(_f8("position", "velocity", "effort", count=None), names=True),
    "geometry_msgs/msg/TwistStamped": MessageType(_f8("linear", "angular")),
    "geometry_msgs/msg/PoseStamped": MessageType((Field("position", "f8", 3), Field("orientation", "f8", 4))),
    "geometry_msgs/msg/WrenchStamped": MessageType(_f8("force", "torque")),
    "sensor_msgs/msg/Joy": MessageType((Field("axes", "f4", None), Field("buttons", "i4", None))),
    "sensor_msgs/msg/Temperature": MessageType(_f8("temperature", "variance", count=1)),
    TEXT: MessageType((), header=False),
}
"""The types a `Stream` can hold, by ROS interface name."""

_INTEGERS = frozenset(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))
_PRIMITIVES = _INTEGERS | {"bool", "byte", "char", "float32", "float64", "string", "wstring"}
_TYPE_NAME = re.compile(r"^([a-zA-Z]\w*)/msg/([A-Z]\w*)$")


@cache
def schema_text(type_name: str) -> str:
    """Return the complete `ros2msg` schema of a type such as `sensor_msgs/msg/JointState`, nested types included.

    Types outside the table above are assembled from the message files installed beside Python (`share/<package>/msg`).

    Raises:
        TopicError: the type is unknown here.
    """
    match = _TYPE_NAME.match(type_name)
    if match is None:
        raise TopicError("not a message type", topic=type_name, remedy="name it as package/msg/Type")
    blocks, waiting, seen = [], ["/".join(match.groups())], set()
    while waiting:
        name = waiting.pop(0)
        if name in seen:
            continue
        seen.add(name)
        text = definition_of(name)
        blocks.append(text if len(seen) == 1 else f"MSG: {name}\n{text}")
        waiting += _nested(text, name.split("/")[0])
    return f"\n{'=' * 80}\n".join(blocks) + "\n"


def definition_of(name: str) -> str:
    """Return the definition of one type such as `std_msgs/Header`, without those of its fields.

    Raises:
        TopicError: the type is unknown here.
    """
    if name in DEFINITIONS:
        return DEFINITIONS[name]
    package, short = name.split("/")
    path = Path(sys.prefix, "share", package, "msg", f"{short}.msg")
    if not path.is_file():
        raise TopicError("no definition of this message type", topic=name, remedy=f"install the package {package}")
    return path.read_text(encoding="utf-8").strip()


def _nested(text: str, package: str) -> list[str]:
    found = []
    for line in field_lines(text):
        kind = re.sub(r"(<=\d+)?(\[.*?\])?$", "", line.split()[0])
        if kind not in _PRIMITIVES:
            found.append(kind if "/" in kind else f"{package}/{kind}")
    return found


def field_lines(text: str) -> list[str]:
    """Return the lines of a definition that declare something, without comments and with single spaces."""
    lines = (" ".join(line.split("#", 1)[0].split()) for line in text.splitlines())
    return [line for line in lines if line]


@lru_cache(maxsize=64)
def same_definition(schema: str, type_name: str) -> bool:
    """Return whether a schema declares the fields of our definition: same types, names and order.

    Default values may differ: they do not change the bytes of a message.
    """
    return _declarations(schema) == _declarations(schema_text(type_name))


def _declarations(schema: str) -> dict[str, list[tuple[str, ...]]]:
    blocks: dict[str, list[tuple[str, ...]]] = {"": []}
    name = ""
    for line in field_lines(schema):
        if line.startswith("MSG: "):
            name = line[5:].split("/")[-1]
            blocks[name] = []
        elif set(line) != {"="}:
            kind, *rest = line.split()
            blocks[name].append((kind.split("/")[-1], *rest[:1]))
    return blocks
