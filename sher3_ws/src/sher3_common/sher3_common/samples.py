"""What travels on the topics, without ROS: one immutable tuple for each message type.

`stamp` is the stamp of the header, whole nanoseconds of the system time. Vectors are plain tuples in SI units. A field
that a joint message leaves empty is None.
"""

from __future__ import annotations

from typing import NamedTuple

from sher3_common.vectors import Vector


class JointSample(NamedTuple):
    """`sensor_msgs/JointState` of the five actuators in the fixed order: m and rad, m/s and rad/s, N and N*m."""

    stamp: int
    position: Vector | None = None
    velocity: Vector | None = None
    effort: Vector | None = None


class TwistSample(NamedTuple):
    """`geometry_msgs/TwistStamped`: `twist` is (vx, vy, vz, wx, wy, wz) in m/s and rad/s."""

    stamp: int
    twist: Vector


class WrenchSample(NamedTuple):
    """`geometry_msgs/WrenchStamped`: `wrench` is (fx, fy, fz, mx, my, mz) in N and N*m."""

    stamp: int
    wrench: Vector


class PoseSample(NamedTuple):
    """`geometry_msgs/PoseStamped`: `position` (3,) in m and `orientation` as the quaternion (x, y, z, w)."""

    stamp: int
    position: Vector
    orientation: Vector


class JoySample(NamedTuple):
    """`sensor_msgs/Joy`: `axes` as 32-bit floats and `buttons` as integers."""

    stamp: int
    axes: Vector
    buttons: tuple[int, ...]


class TextSample(NamedTuple):
    """`std_msgs/String`, which has no header."""

    text: str


class TemperatureSample(NamedTuple):
    """`sensor_msgs/Temperature` in degrees Celsius."""

    stamp: int
    temperature: float


class DiagnosticSample(NamedTuple):
    """One status of a `diagnostic_msgs/DiagnosticArray`: `level` 0 ok, 1 warning, 2 error, 3 stale."""

    stamp: int
    name: str
    level: int
    message: str
    values: tuple[tuple[str, str], ...] = ()


Sample = (
    JointSample
    | TwistSample
    | WrenchSample
    | PoseSample
    | JoySample
    | TextSample
    | TemperatureSample
    | DiagnosticSample
)
