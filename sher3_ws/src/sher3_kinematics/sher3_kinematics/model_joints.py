"""Positions of the URDF's joints from actuator positions: what `/joint_states` and `/tf` carry."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_kinematics.arrays import Floats
from sher3_kinematics.robot_kinematics import RobotKinematics

MODEL_JOINTS = (
    "delta_1",
    "delta_2",
    "delta_3",
    "platform_x",
    "platform_y",
    "platform_z",
    "roll",
    "tilt_angle",
)
"""Movable joints of `sher3_description.urdf`, in the order of `model_positions`."""


def model_positions(kinematics: RobotKinematics, q: Sequence[float] | Floats) -> tuple[float, ...]:
    """Return the position (8,) [m, rad] of every joint of `MODEL_JOINTS` for actuator positions q (5,).

    Raises:
        BadInput: q is not five finite numbers.
        Unreachable: the legs do not meet or the tilt slider is beyond a dead point.
    """
    x, y, z = kinematics.delta.forward(q[:3])
    tilt = kinematics.tilt_linkage.angle(float(q[4]))
    return (*(float(v) for v in q[:3]), float(x), float(y), float(z), float(q[3]), tilt)
