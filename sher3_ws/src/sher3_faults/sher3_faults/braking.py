"""How far the tip travels while the robot brakes: an upper bound over postures and directions.

Two ways to stop. *Zero*: the drives get the demand zero at once and follow it with their velocity loop. Its PI law
(recorded-run contract, section 3) carries an axis on by no more than v m/kp. *Ramp*: each drive brakes on its own,
v^2/(2a) beyond that lag; the axes come to rest at different times, so the tip leaves its path, and a roll of 0.3 rad/s
alone takes 15 ms. Both are bounded by trying tip velocities of full speed in many directions at many postures.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import product

import numpy as np
from numpy.typing import NDArray
from sher3_description import Robot
from sher3_kinematics import RobotKinematics

Array = NDArray[np.float64]
REACH = 0.4
"""Share of each axis' travel to both sides within which postures are tried."""
INSTANTS = 9
"""Number of instants of the braking at which the place of the tip is computed."""


class Braking:
    """Braking distances of a robot.

    Args:
        robot: the robot.
        postures: number of postures that are tried.
    """

    def __init__(self, robot: Robot, postures: int = 32) -> None:
        kinematics = RobotKinematics(robot)
        axes = robot.actuators
        self.lag = np.array([axis.mass / axis.drive.kp for axis in axes])
        self.deceleration = np.array([axis.limits.acceleration for axis in axes])
        self.velocity = np.array([axis.limits.velocity for axis in axes])
        centre = np.array([(axis.limits.upper + axis.limits.lower) / 2.0 for axis in axes])
        half = np.array([(axis.limits.upper - axis.limits.lower) / 2.0 for axis in axes])
        draw = np.random.default_rng(0).uniform(-1.0, 1.0, (postures, 5))
        # The legs move together for most of their travel: positions far apart lie outside the workspace.
        draw[:, :3] = draw[:, :1] + 0.5 * (draw[:, :3] - draw[:, :1])
        self.jacobians = np.array([kinematics.jacobian(q) for q in centre + REACH * half * draw])

    def reach(self) -> Array:
        """Return the tip's travel per motion of each axis (5,) [m/m, m/rad], the largest of all postures."""
        return np.asarray(np.linalg.norm(self.jacobians[:, :3], axis=1).max(axis=0))

    def top_speed(self) -> float:
        """Return the largest tip speed [m/s] with every axis at its own limit."""
        signs = np.array(list(product((-1.0, 1.0), repeat=5))) * self.velocity
        return float(np.linalg.norm(self.jacobians[:, None, :3] @ signs[None, :, :, None], axis=2).max())

    def axis_speeds(self, linear: float, angular: float) -> Array:
        """Return the largest speed of each axis (5,) [m/s, rad/s] at tip speeds [m/s] and [rad/s]."""
        return np.asarray(np.abs(self._axis_velocities(linear, angular)).max(axis=(0, 1)))

    def _axis_velocities(self, linear: float, angular: float) -> Array:
        """Return axis velocities (postures, directions, 5) of full speed, scaled as a whole into the axes' limits."""
        velocity = np.einsum("pij,tj->pti", np.linalg.pinv(self.jacobians), _twists(linear, angular))
        velocity /= np.maximum(1.0, np.abs(velocity / self.velocity).max(axis=2, keepdims=True))
        return velocity

    def distances(self, linear: float, angular: float) -> tuple[float, float]:
        """Return the tip's travel [m] after a stop by zero demand and by ramp, from tip speeds [m/s] and [rad/s]."""
        velocity = self._axis_velocities(linear, angular)
        zero = self._tip(velocity * self.lag)
        times = np.abs(velocity) / self.deceleration
        ramp = 0.0
        for share in np.linspace(1.0 / INSTANTS, 1.0, INSTANTS):
            t = np.minimum(share * times.max(axis=2, keepdims=True), times)
            way = velocity * t - 0.5 * np.sign(velocity) * self.deceleration * t * t + velocity * self.lag
            ramp = max(ramp, self._tip(way))
        return zero, ramp

    def _tip(self, motion: Array) -> float:
        """Return the longest tip displacement [m] of actuator motions (postures, directions, 5)."""
        return float(np.linalg.norm(np.einsum("pij,ptj->pti", self.jacobians[:, :3], motion), axis=2).max())


def _twists(linear: float, angular: float) -> Array:
    """Return tip velocities of full speed: 26 directions, each without and with a turn about x, y and z either way."""
    ways = np.array([way for way in product((-1.0, 0.0, 1.0), repeat=3) if any(way)])
    ways = linear * ways / np.linalg.norm(ways, axis=1, keepdims=True)
    turns = np.vstack([np.zeros((1, 3)), angular * np.eye(3), -angular * np.eye(3)])
    return np.array([[*way, *turn] for way in ways for turn in turns])


@lru_cache(maxsize=4)
def braking_of(text: str) -> Braking:
    """Return the braking distances of the robot of a robot file's text; kept, since they take 50 ms."""
    return Braking(Robot.from_yaml(text))
