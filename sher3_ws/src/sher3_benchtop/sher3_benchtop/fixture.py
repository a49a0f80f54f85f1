"""The robot on the bench: where the hand pushes, what measures the force, and who looks at the tip."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sher3_description import Robot
from sher3_kinematics import RobotKinematics
from sher3_paper.grasp import Setup

Floats = NDArray[np.float64]
GRASP_FROM_PLATFORM = np.array(Setup().lever)
"""Grasping point seen from P [m] at zero roll and tilt: the assumption under which the deflection table is fitted."""


def bench_robot(robot: Robot) -> Robot:
    """Return the robot as it stands on the bench.

    The force sensor sits where the hand pushes, as in the paper's deflection test: at its place behind the tool, 8 N at
    the grasping point would turn 0.3 N m about a sensor with a range of 0.12 N m. The tracker is without noise; it
    stands for the true tip, and the cameras add what cameras add.
    """
    data = robot.model_dump()
    data["force_sensor"]["position"] = tuple(grasp_from_tip(robot).tolist())
    data["tracker"] |= {"noise_position": 0.0, "noise_rotation": 0.0}
    return Robot.model_validate(data)


def home(robot: Robot) -> Floats:
    """Return the tip position (3,) [m] in {b} with all actuators at zero."""
    return RobotKinematics(robot).transform_tip_to_base(np.zeros(5))[:3, 3]


def grasp_from_tip(robot: Robot) -> Floats:
    """Return the grasping point (3,) [m] seen from the tip, axes of {t}, parallel to {b} at zero roll and tilt."""
    kinematics = RobotKinematics(robot)
    tip = kinematics.transform_tip_to_base(np.zeros(5))[:3, 3]
    return GRASP_FROM_PLATFORM - (tip - kinematics.delta.forward(np.zeros(3)))


def wrench_at_tip(robot: Robot, force: Floats) -> Floats:
    """Return the wrench (n, 6) at the tip that forces (n, 3) [N] at the grasping point amount to."""
    return np.hstack((force, np.cross(grasp_from_tip(robot), force)))
