"""Message classes of the topics and the conversion between samples and message objects.

The graph itself runs on raw bytes (see `cdr`). Message objects serve the baseline of the bench and the tests of the
codecs.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import Any

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
from sher3_description import ACTUATORS
from sher3_description.topics import Topic


@cache
def message_class(type_name: str) -> Any:
    """Return the rclpy class of `package/msg/Name`."""
    package, _, name = type_name.split("/")
    return getattr(import_module(f"{package}.msg"), name)


def to_message(topic: Topic, sample: Sample) -> Any:
    """Return the message object of a sample."""
    message = message_class(topic.type)()
    if isinstance(sample, TextSample):
        message.data = sample.text
        return message
    message.header.frame_id = topic.frame
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(sample.stamp, SECOND)
    _FILL[type(sample)](message, sample)
    return message


def from_message(topic: Topic, message: Any) -> Any:
    """Return the sample of a message object."""
    name = topic.type.rsplit("/", 1)[-1]
    if name == "String":
        return TextSample(message.data)
    stamp = message.header.stamp.sec * SECOND + message.header.stamp.nanosec
    return _READ[name](stamp, message)


def _set(target: Any, names: str, values: Any) -> None:
    for name, value in zip(names.split(), values, strict=True):
        setattr(target, name, value)


def _get(source: Any, names: str) -> tuple[Any, ...]:
    return tuple(getattr(source, name) for name in names.split())


def _fill_joints(message: Any, sample: JointSample) -> None:
    message.name = list(ACTUATORS)
    _set(message, "position velocity effort", [list(field or ()) for field in sample[1:]])


def _fill_twist(message: Any, sample: TwistSample) -> None:
    _set(message.twist.linear, "x y z", sample.twist[:3])
    _set(message.twist.angular, "x y z", sample.twist[3:])


def _fill_wrench(message: Any, sample: WrenchSample) -> None:
    _set(message.wrench.force, "x y z", sample.wrench[:3])
    _set(message.wrench.torque, "x y z", sample.wrench[3:])


def _fill_pose(message: Any, sample: PoseSample) -> None:
    _set(message.pose.position, "x y z", sample.position)
    _set(message.pose.orientation, "x y z w", sample.orientation)


def _fill_joy(message: Any, sample: JoySample) -> None:
    message.axes, message.buttons = list(sample.axes), list(sample.buttons)


def _fill_temperature(message: Any, sample: TemperatureSample) -> None:
    message.temperature = sample.temperature


def _fill_diagnostic(message: Any, sample: DiagnosticSample) -> None:
    status = message_class("diagnostic_msgs/msg/DiagnosticStatus")(
        level=bytes([sample.level]), name=sample.name, message=sample.message, hardware_id="sher3"
    )
    pair = message_class("diagnostic_msgs/msg/KeyValue")
    status.values = [pair(key=key, value=value) for key, value in sample.values]
    message.status = [status]


_FILL: dict[type, Any] = {
    JointSample: _fill_joints,
    TwistSample: _fill_twist,
    WrenchSample: _fill_wrench,
    PoseSample: _fill_pose,
    JoySample: _fill_joy,
    TemperatureSample: _fill_temperature,
    DiagnosticSample: _fill_diagnostic,
}


def _read_diagnostic(stamp: int, message: Any) -> DiagnosticSample:
    status = message.status[0]
    values = tuple((pair.key, pair.value) for pair in status.values)
    return DiagnosticSample(stamp, status.name, status.level[0], status.message, values)


_READ: dict[str, Any] = {
    "JointState": lambda t, m: JointSample(t, *(tuple(f) or None for f in (m.position, m.velocity, m.effort))),
    "TwistStamped": lambda t, m: TwistSample(t, _get(m.twist.linear, "x y z") + _get(m.twist.angular, "x y z")),
    "WrenchStamped": lambda t, m: WrenchSample(t, _get(m.wrench.force, "x y z") + _get(m.wrench.torque, "x y z")),
    "PoseStamped": lambda t, m: PoseSample(t, _get(m.pose.position, "x y z"), _get(m.pose.orientation, "x y z w")),
    "Joy": lambda t, m: JoySample(t, tuple(m.axes), tuple(m.buttons)),
    "Temperature": lambda t, m: TemperatureSample(t, m.temperature),
    "DiagnosticArray": _read_diagnostic,
}
