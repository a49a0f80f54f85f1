"""What the axes of the robot carry."""

from __future__ import annotations

from sher3_description import Robot


def carried_mass(robot: Robot, row: int) -> float:
    """Return the nominal mass (kg) whose weight an axis carries."""
    arm = robot.arm
    return (robot.delta.moving_mass if row < 3 else arm.tilt_mass + (arm.roll_mass if row == 3 else 0.0)) or 1.0
