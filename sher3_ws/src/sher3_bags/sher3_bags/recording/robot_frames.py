"""The robot beside its streams: description, joint states, transforms, legs as markers. A bag opens as a robot.

RViz and Foxglove draw a robot from `/robot_description` and `/tf`. Nothing publishes them on the graph for a recording,
since nothing there needs them: they follow from the robot file and from `measured_js`, and are made here.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_common.stamps import SECOND
from sher3_description import Qos, Robot
from sher3_description.urdf import urdf
from sher3_kinematics import BadInput, RobotKinematics, Unreachable
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
_STAMP = struct.Struct("<iI")


class Link(NamedTuple):
    """A movable joint as a transform: parent and child link, its origin in the parent and its axis (3,)."""

    parent: str
    child: str
    origin: tuple[float, float, float]
    axis: tuple[float, float, float]
    turns: bool


class RobotFrames:
    """Makes the robot's description, joint states, transforms and legs from what a recorder hears.

    Args:
        robot: in force.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._kinematics = RobotKinematics(robot)
        self._links = _links(robot)
        self._half = robot.delta.leg_width / 2
        self._base = math.sqrt(robot.delta.base_radius**2 - self._half**2)
        self._platform = math.sqrt(robot.delta.platform_radius**2 - self._half**2)
        self._next = -(2**62)

    def fixed(self, stamp: int) -> list[Made]:
        """Return what never changes: the URDF and the transforms of its fixed joints; stamp in ns."""
        arm, sensor = self._robot.arm, self._robot.force_sensor
        still = [("a", "t", arm.tool, (0.0, 0.0, 0.0, 1.0)), ("t", "f", sensor.position, (0.0, 0.0, 0.0, 1.0))]
        return [
            Made("/robot_description", TEXT, LATCHED, text(urdf(self._robot))),
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
        moving = [(*link[:2], *link_transform(link, at)) for link, at in zip(self._links, positions, strict=True)]
        return [
            Made("/joint_states", JOINT_STATE, Qos(), joint_state(stamp, MODEL_JOINTS, positions)),
            Made("/tf", TF, Qos(), transforms(stamp, moving)),
            Made("/sher3/markers", MARKER, Qos(), lines(stamp, "b", "legs", LEG_WIDTH, self._legs(positions))),
        ]

    def _legs(self, positions: tuple[float, ...]) -> list[tuple[float, float, float]]:
        """Return the ends (12, 3) [m] in {b} of the six legs, two after two."""
        ends = []
        x, y, z = positions[3:6]
        for k, azimuth in enumerate(self._robot.delta.leg_azimuth):
            c, s = math.cos(azimuth), math.sin(azimuth)
            height = positions[k] + self._robot.delta.slider_zero
            for side in (-self._half, self._half):
                ends.append((self._base * c - side * s, self._base * s + side * c, height))
                ends.append((x + self._platform * c - side * s, y + self._platform * s + side * c, z))
        return ends


def _links(robot: Robot) -> list[Link]:
    """Return the movable joints of the URDF in the order of `MODEL_JOINTS`."""
    half = robot.delta.leg_width / 2
    radius = math.sqrt(robot.delta.base_radius**2 - half**2)
    up, zero = (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)
    sliders = [
        Link("b", f"slider_{k + 1}", (radius * math.cos(a), radius * math.sin(a), robot.delta.slider_zero), up, False)
        for k, a in enumerate(robot.delta.leg_azimuth)
    ]
    arm = robot.arm
    return [
        *sliders,
        Link("b", "p_x", zero, (1.0, 0.0, 0.0), False),
        Link("p_x", "p_y", zero, (0.0, 1.0, 0.0), False),
        Link("p_y", "p", zero, up, False),
        Link("p", "r", (0.0, 0.0, arm.d1), (1.0, 0.0, 0.0), True),
        Link("r", "a", (arm.d2, 0.0, arm.d3), (0.0, 1.0, 0.0), True),
    ]


def link_transform(link: Link, position: float) -> tuple[Triple, Quaternion]:
    """Return translation (3,) [m] and rotation (x, y, z, w) of a joint at a position [m, rad]."""
    if link.turns:
        s, c = math.sin(position / 2), math.cos(position / 2)
        x, y, z = link.axis
        return link.origin, (s * x, s * y, s * z, c)
    x, y, z = (o + position * a for o, a in zip(link.origin, link.axis, strict=True))
    return (x, y, z), (0.0, 0.0, 0.0, 1.0)
