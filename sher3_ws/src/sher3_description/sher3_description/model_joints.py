"""The joints of the robot's tree: what its URDF, its transforms and its viewers are made of.

URDF knows trees only. The delta stage therefore appears as three translations of the platform beside the three sliders
on their rails; the tilt joint is the angle, not the slider.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sher3_description.robot import Robot

Triple = tuple[float, float, float]
ZERO: Triple = (0.0, 0.0, 0.0)
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


class ModelJoint(NamedTuple):
    """A joint between two links.

    Attributes:
        name: of the joint.
        kind: `prismatic`, `revolute` or `fixed`.
        parent, child: names of the links.
        origin: of the child in the parent's frame at position zero (3,) [m].
        axis: direction of motion in the parent's frame (3,); of no meaning when fixed.
    """

    name: str
    kind: str
    parent: str
    child: str
    origin: Triple
    axis: Triple = Z

    def prefixed(self, prefix: str) -> ModelJoint:
        """Return the joint with `prefix` before its own name and those of its links."""
        names = {name: prefix + getattr(self, name) for name in ("name", "parent", "child")}
        return self._replace(**names)


def moving_joints(robot: Robot, prefix: str = "") -> list[ModelJoint]:
    """Return the movable joints in the order of `sher3_kinematics.model_joints.MODEL_JOINTS`.

    `prefix` stands before the names of joints and links.
    """
    delta, arm = robot.delta, robot.arm
    out = delta.base_distance
    sliders = [
        ModelJoint(
            robot.actuators[k].name,
            "prismatic",
            "b",
            f"slider_{k + 1}",
            (out * math.cos(azimuth), out * math.sin(azimuth), delta.slider_zero),
        )
        for k, azimuth in enumerate(delta.leg_azimuth)
    ]
    joints = [
        *sliders,
        ModelJoint("platform_x", "prismatic", "b", "p_x", ZERO, X),
        ModelJoint("platform_y", "prismatic", "p_x", "p_y", ZERO, Y),
        ModelJoint("platform_z", "prismatic", "p_y", "p", ZERO, Z),
        ModelJoint("roll", "revolute", "p", "r", (0.0, 0.0, arm.d1), X),
        ModelJoint("tilt_angle", "revolute", "r", "a", (arm.d2, 0.0, arm.d3), Y),
    ]
    return [joint.prefixed(prefix) for joint in joints]


def fixed_joints(robot: Robot, prefix: str = "") -> list[ModelJoint]:
    """Return the joints that never move, tool and force sensor; `prefix` as for `moving_joints`."""
    joints = [
        ModelJoint("tip", "fixed", "a", "t", robot.arm.tool),
        ModelJoint("force_sensor", "fixed", "t", "f", robot.force_sensor.position),
    ]
    return [joint.prefixed(prefix) for joint in joints]
