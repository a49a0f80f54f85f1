"""What weight and contact do on the axes: the contract's G(q) - J(q)^T W along the set-points, and G's slope there.

The axes follow their set-points within a millimetre, where the linear continuation is exact to 1e-4 N.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from sher3_description import Robot
from sher3_description.contract import GRAVITY

from sher3_challenge.oracle.nominal import platform_centre, tilt_angle
from sher3_challenge.plants.mujoco.axes.parts import AXES, ROLL, TILT, Array

STEP = 1e-4  # m or rad: differences of G over it are exact to 1e-6 of G


class Field(NamedTuple):
    """Loads per tick: weight that the drives hold, its slope by position, and the force of the contact."""

    gravity: Array  # (n, 5)
    slope: Array  # (n, 5, 5)
    contact: Array  # (n, 5)


def field_along(robot: Robot, position: Array, force: Array) -> Field:
    """Return the loads along set-points (n, 5) under forces (n, 3) at the tip in {b}."""
    return _field(robot, len(position), np.ascontiguousarray(position).tobytes(), np.ascontiguousarray(force).tobytes())


@lru_cache(maxsize=16)
def _field(robot: Robot, n: int, position: bytes, force: bytes) -> Field:
    q = np.frombuffer(position).reshape(n, AXES)
    slope = np.empty((n, AXES, AXES))
    for i in range(AXES):
        move = STEP * np.eye(AXES)[i]
        slope[:, :, i] = (gravity(robot, q + move) - gravity(robot, q - move)) / (2 * STEP)
    return Field(gravity(robot, q), slope, contact_force(robot, q, np.frombuffer(force).reshape(n, 3)))


def sliders_to_platform(robot: Robot, q: Array) -> Array:
    """Return (n, 3, 3) dP / dq of the delta: every link keeps its length, u . (dP - dq z) = 0."""
    delta = robot.delta
    azimuth = np.asarray(delta.leg_azimuth)
    foot = delta.leg_offset * np.column_stack([np.cos(azimuth), np.sin(azimuth), np.zeros(3)])
    link = platform_centre(robot, q)[:, None] - foot
    link[:, :, 2] -= q[:, :3] + delta.slider_zero
    return np.asarray(np.linalg.solve(link, link[:, :, 2, None] * np.eye(3)))


def tilt_ratio(robot: Robot, angle: Array) -> Array:
    """Return (n,) d angle / d slider of the tilt linkage."""
    linkage = robot.tilt_linkage
    height = linkage.offset - linkage.crank * np.cos(angle)
    lean = height / np.sqrt(linkage.coupler**2 - height**2)
    return np.asarray(1 / (linkage.crank * (np.cos(angle) - lean * np.sin(angle))))


def gravity(robot: Robot, q: Array) -> Array:
    """Return (n, 5) the weight G(q) that the drives hold."""
    arm, angle = robot.arm, tilt_angle(robot, q[:, TILT])
    sin, cos = np.sin(q[:, ROLL]), np.cos(q[:, ROLL])
    x, y, z = arm.tilt_com
    turned_z = z * np.cos(angle) - x * np.sin(angle)
    roll = arm.roll_mass * (arm.roll_com[1] * cos - arm.roll_com[2] * sin)
    roll += arm.tilt_mass * (y * cos - (arm.d3 + turned_z) * sin)
    tilt = -arm.tilt_mass * cos * (z * np.sin(angle) + x * np.cos(angle)) * tilt_ratio(robot, angle)
    delta = robot.delta.moving_mass * sliders_to_platform(robot, q)[:, 2, :]
    return np.asarray(GRAVITY * np.column_stack([delta, roll, tilt]))


def contact_force(robot: Robot, q: Array, force: Array) -> Array:
    """Return (n, 5) J(q)^T of forces (n, 3) at the tip."""
    if not force.any():
        return np.zeros((len(q), AXES))
    arm, angle = robot.arm, tilt_angle(robot, q[:, TILT])
    tool = np.asarray(arm.tool)
    # the force in {r}, where the tilt axis is y
    sin, cos = np.sin(q[:, ROLL]), np.cos(q[:, ROLL])
    fx, fy, fz = force[:, 0], cos * force[:, 1] + sin * force[:, 2], cos * force[:, 2] - sin * force[:, 1]
    ahead = tool[0] * np.cos(angle) + tool[2] * np.sin(angle)
    above = tool[2] * np.cos(angle) - tool[0] * np.sin(angle)
    roll = tool[1] * fz - (arm.d3 + above) * fy
    tilt = (above * fx - ahead * fz) * tilt_ratio(robot, angle)
    delta = np.einsum("nik,ni->nk", sliders_to_platform(robot, q), force)
    return np.column_stack([delta, roll, tilt])
