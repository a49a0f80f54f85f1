"""The robot beside its streams: description, joint states, transforms, legs as markers. A bag opens as a robot.

RViz and Foxglove draw a robot from `/robot_description` and `/tf`. Nothing publishes them on the graph for a recording,
since nothing there needs them: they follow from the robot file and from `measured_js`, and are made here.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from sher3_common.namespace import prefix
from sher3_common.stamps import SECOND
from sher3_description import Qos, Robot
from sher3_description.model_joints import ModelJoint, fixed_joints, moving_joints
from sher3_description.urdf import urdf
from sher3_kinematics import BadInput, RobotKinematics, Unreachable
from sher3_kinematics.deflection import ball_centres
from sher3_kinematics.model_joints import MODEL_JOINTS, model_positions

from sher3_bags.codec.cdr import STAMP, read_layout
from sher3_bags.codec.pack import Quaternion, Triple, joint_state, lines, text, transforms
from sher3_bags.errors import MalformedMessageError
from sher3_bags.messages import TEXT
from sher3_bags.recording.made import Made

JOINT_STATE, TF = "sensor_msgs/msg/JointState", "tf2_msgs/msg/TFMessage"
MARKER = "visualization_msgs/msg/Marker"
LATCHED = Qos(durability="transient_local", depth=1)
SOURCE = "measured_js"
"""Topic from which the joints follow."""
PERIOD_NS = 20_000_000
"""Time between two states: 50 Hz, more than a screen shows of a hand's motion."""
LEG_WIDTH = 0.0044
"""Thickness of a drawn leg [m]."""
UPRIGHT: Quaternion = (0.0, 0.0, 0.0, 1.0)
"""The rotation that turns nothing."""
_STAMP = struct.Struct("<iI")


class RobotFrames:
    """Makes the robot's description, joint states, transforms and legs from what a recorder hears.

    Args:
        robot: in force; its frames and joints have the prefix of its namespace.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot, self._prefix = robot, prefix()
        self._kinematics = RobotKinematics(robot)
        self._joints = moving_joints(robot, self._prefix)
        self._names = [self._prefix + name for name in MODEL_JOINTS]
        base, platform = ball_centres(robot)
        self._balls = base + np.array([0.0, 0.0, robot.delta.slider_zero]), platform
        self._next = -(2**62)

    def fixed(self, stamp: int) -> list[Made]:
        """Return what never changes: the URDF and the transforms of its fixed joints; stamp in ns."""
        still = [
            (joint.parent, joint.child, joint.origin, UPRIGHT) for joint in fixed_joints(self._robot, self._prefix)
        ]
        return [
            Made("/robot_description", TEXT, LATCHED, text(urdf(self._robot, self._prefix))),
            Made("/tf_static", TF, LATCHED, transforms(stamp, still)),
        ]

    def follow(self, data: bytes) -> list[Made]:
        """Return the state that follows from a message of `measured_js`, 50 times a second; else nothing.

        A message of other joints has no state, nor have bytes that are no message; the recording keeps both.
        """
        if len(data) < STAMP + _STAMP.size:
            return []
        seconds, nanoseconds = _STAMP.unpack_from(data, STAMP)
        stamp = seconds * SECOND + nanoseconds
        if stamp < self._next:
            return []
        self._next = stamp + PERIOD_NS
        try:
            layout = read_layout(data, JOINT_STATE, topic=SOURCE)
        except MalformedMessageError:
            return []
        entry, start, count = layout.slots[0]
        if entry.name != "position" or count != len(self._robot.actuators):
            return []
        return self.state(stamp, np.frombuffer(data, layout.order + "f8", count, start))

    def state(self, stamp: int, q: Sequence[float] | NDArray[np.float64]) -> list[Made]:
        """Return joint states, transforms and legs at a stamp [ns] for actuator positions q (5,) [m, m, m, rad, m].

        Positions that the legs cannot reach have none.
        """
        try:
            positions = model_positions(self._kinematics, q)
        except (BadInput, Unreachable):
            return []
        moving = [
            (joint.parent, joint.child, *joint_transform(joint, at))
            for joint, at in zip(self._joints, positions, strict=True)
        ]
        legs = self._legs(positions)
        return [
            Made("/joint_states", JOINT_STATE, Qos(), joint_state(stamp, self._names, positions)),
            Made("/tf", TF, Qos(), transforms(stamp, moving)),
            Made("/sher3/markers", MARKER, Qos(), lines(stamp, f"{self._prefix}b", "legs", LEG_WIDTH, legs)),
        ]

    def _legs(self, positions: tuple[float, ...]) -> list[tuple[float, float, float]]:
        """Return the ends (12, 3) [m] in {b} of the six legs, two after two."""
        base, platform = self._balls
        heights = np.repeat(positions[:3], 2)
        ends = np.stack([base + np.outer(heights, (0.0, 0.0, 1.0)), platform + positions[3:6]], axis=1)
        return [(x, y, z) for x, y, z in ends.reshape(-1, 3).tolist()]


def joint_transform(joint: ModelJoint, position: float) -> tuple[Triple, Quaternion]:
    """Return translation (3,) [m] and rotation (x, y, z, w) of a joint at a position [m, rad]."""
    if joint.kind == "revolute":
        s, c = math.sin(position / 2), math.cos(position / 2)
        x, y, z = joint.axis
        return joint.origin, (s * x, s * y, s * z, c)
    x, y, z = (o + position * a for o, a in zip(joint.origin, joint.axis, strict=True))
    return (x, y, z), UPRIGHT
