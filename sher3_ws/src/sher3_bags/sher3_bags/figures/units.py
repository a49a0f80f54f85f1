"""The SI unit of every number that a stream carries."""

from __future__ import annotations

from functools import cache

from sher3_description import load_robot

_COLUMNS = {
    ("sensor_msgs/msg/JointState", "position"): ("m", "rad"),
    ("sensor_msgs/msg/JointState", "velocity"): ("m/s", "rad/s"),
    ("sensor_msgs/msg/JointState", "effort"): ("N", "N m"),
}
_OTHERS = {
    ("geometry_msgs/msg/TwistStamped", "linear"): "m/s",
    ("geometry_msgs/msg/TwistStamped", "angular"): "rad/s",
    ("geometry_msgs/msg/PoseStamped", "position"): "m",
    ("geometry_msgs/msg/WrenchStamped", "force"): "N",
    ("geometry_msgs/msg/WrenchStamped", "torque"): "N m",
    ("sensor_msgs/msg/Temperature", "temperature"): "K",
}


def unit_of(type_name: str, column: str, axis: str) -> str:
    """Return the unit of a column of a message type on an axis (actuator or component); empty for a pure number.

    A difference of temperatures is in K, whatever their zero.
    """
    linear, angular = _COLUMNS.get((type_name, column), ("", ""))
    if not linear:
        return _OTHERS.get((type_name, column), "")
    return angular if axis in _revolute() else linear


@cache
def _revolute() -> frozenset[str]:
    return frozenset(actuator.name for actuator in load_robot().actuators if actuator.kind == "revolute")
