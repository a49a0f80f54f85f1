"""Geometry of a virtual remote centre of motion: the shaft point at the centre, and velocities that keep it there.

The constraint is two-dimensional: the shaft point nearest the centre must not move across the shaft. Roll rate, tilt
rate and insertion speed stay free, and with them the motion is determined.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .arrays import Floats, vector
from .robot_kinematics import RobotKinematics


class ShaftPoint(NamedTuple):
    """The point of the shaft line nearest the remote centre, all in {b}.

    Attributes:
        position: the point (3,) [m].
        axis: unit direction (3,) in which the needle points.
        depth: distance [m] from the point to the tip along the axis; positive with the needle past the centre.
        deviation: position minus centre (3,) [m], across the axis.
    """

    position: Floats
    axis: Floats
    depth: float
    deviation: Floats


class RemoteCentre:
    """A remote centre fixed in {b} for one robot.

    Attributes:
        centre: the point (3,) [m] in {b} through which the shaft must pass.
    """

    def __init__(self, kinematics: RobotKinematics, centre: Sequence[float] | Floats) -> None:
        self.kinematics = kinematics
        self.centre = vector(centre, 3, "remote centre")

    def shaft_point(self, q: Sequence[float] | Floats) -> ShaftPoint:
        """Return the shaft point nearest the centre at actuator positions q (5,)."""
        transform = self.kinematics.transform_tip_to_base(q)
        tip, axis = transform[:3, 3], -transform[:3, 2]
        depth = float(axis @ (tip - self.centre))
        position = tip - depth * axis
        return ShaftPoint(position, axis, depth, position - self.centre)

    def jacobian(self, q: Sequence[float] | Floats) -> Floats:
        """Return the Jacobian (3, 5) from actuator velocities to the velocity of the shaft point, a point of the tool.

        J_s = J_v - [s - p]x J_w with s the shaft point and p the tip.
        """
        jacobian, shaft = self.kinematics.jacobian(q), self.shaft_point(q)
        arm = -shaft.depth * shaft.axis
        return jacobian[:3] + np.cross(jacobian[3:].T, arm).T

    def constraint(self, q: Sequence[float] | Floats) -> tuple[Floats, Floats]:
        """Return rows B_perp J_s (2, 5) and deviation B_perp (s - c) (2,) [m]; keep `rows @ q_dot = -k deviation`.

        B_perp holds two unit vectors across the shaft: y of {r}, which the shaft never meets, and its complement.
        """
        shaft = self.shaft_point(q)
        first = np.array([0.0, np.cos(q[3]), np.sin(q[3])])
        first -= (first @ shaft.axis) * shaft.axis
        first /= np.linalg.norm(first)
        across = np.array([first, np.cross(shaft.axis, first)])
        return across @ self.jacobian(q), across @ shaft.deviation

    def twist(
        self, q: Sequence[float] | Floats, roll_rate: float, tilt_rate: float, insertion: float, gain: float
    ) -> Floats:
        """Return the tip twist (6,) in {b} that keeps the remote centre.

        Args:
            q: actuator positions (5,).
            roll_rate: angular velocity [rad/s] about x of {b}.
            tilt_rate: angular velocity [rad/s] about y of {r}.
            insertion: speed [m/s] along the shaft, positive into the eye.
            gain: rate [1/s] at which a deviation decays.
        """
        shaft = self.shaft_point(q)
        roll = float(q[3]) + self.kinematics.parameters.zero_4
        angular = np.array([roll_rate, tilt_rate * np.cos(roll), tilt_rate * np.sin(roll)])
        linear = insertion * shaft.axis - gain * shaft.deviation + np.cross(angular, shaft.depth * shaft.axis)
        return np.concatenate((linear, angular))
