"""Point-to-point motion with limited jerk, along a straight line; all axes start and stop together.

One path coordinate s goes from 0 to 1 with a velocity profile of seven phases. It is the fastest profile within caps on
velocity, acceleration and jerk (Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots,
section 3.4, double S from rest to rest). The caps of s are those of the tightest axis, so no axis exceeds its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sher3_control.errors import TrajectoryError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class DoubleS:
    """Profile from rest to rest over a path of length 1.

    Attributes:
        t_jerk: length of each of the four jerk phases [s].
        t_acceleration: time from rest to the cruising speed, and from there to rest [s].
        t_cruise: length of the phase of constant velocity [s].
        jerk: [1/s^3].
    """

    t_jerk: float
    t_acceleration: float
    t_cruise: float
    jerk: float

    @property
    def duration(self) -> float:
        """Length of the whole motion [s]."""
        return 2.0 * self.t_acceleration + self.t_cruise

    def at(self, t: float) -> tuple[float, float]:
        """Return s and ds/dt [1/s] at `t` [s] after the start; s rests at 0 before the motion and at 1 after it."""
        if t <= 0.0:
            return 0.0, 0.0
        if t >= self.duration:
            return 1.0, 0.0
        if t > 0.5 * self.duration:
            s, v = self.at(self.duration - t)
            return 1.0 - s, v
        if t <= self.t_acceleration:
            return self._speed_up(t)
        s, v = self._speed_up(self.t_acceleration)
        return s + v * (t - self.t_acceleration), v

    def _speed_up(self, t: float) -> tuple[float, float]:
        """Return s and ds/dt [1/s] at `t` [s] within the speeding-up."""
        j, tj, ta = self.jerk, self.t_jerk, self.t_acceleration
        if t <= tj:
            return j * t**3 / 6.0, 0.5 * j * t * t
        a = j * tj
        if t <= ta - tj:
            return a * (3.0 * t * t - 3.0 * tj * t + tj * tj) / 6.0, a * (t - 0.5 * tj)
        v, rest = a * (ta - tj), ta - t
        return 0.5 * v * ta - v * rest + j * rest**3 / 6.0, v - 0.5 * j * rest * rest


def double_s(velocity: float, acceleration: float, jerk: float) -> DoubleS:
    """Return the fastest profile from rest to rest over a path of length 1, within caps [1/s], [1/s^2], [1/s^3]."""
    tj = min(acceleration / jerk, math.sqrt(velocity / jerk), (0.5 / jerk) ** (1.0 / 3.0))
    a = jerk * tj
    ta = tj + min(velocity / a, 0.5 * (math.sqrt(tj * tj + 4.0 / a) - tj))
    ta = max(ta, 2.0 * tj)
    v = a * (ta - tj)
    return DoubleS(tj, ta, max(1.0 / v - ta, 0.0), jerk)


@dataclass(frozen=True)
class JointMove:
    """A planned straight line in actuator space.

    Attributes:
        start, goal: actuator positions (5,).
        profile: path coordinate over time.
    """

    start: Array
    goal: Array
    profile: DoubleS

    @property
    def duration(self) -> float:
        """Length of the motion [s]."""
        return self.profile.duration

    def at(self, t: float) -> tuple[Array, Array]:
        """Return reference positions (5,) and velocities (5,) at `t` [s] after the start."""
        s, rate = self.profile.at(t)
        change = self.goal - self.start
        return (self.goal if s >= 1.0 else self.start + s * change), rate * change


def plan_joint_move(start: Array, goal: Array, velocity: Array, acceleration: Array, jerk: Array) -> JointMove:
    """Plan a synchronised move from `start` to `goal` within caps per axis; all arrays (5,).

    Raises:
        TrajectoryError: start or goal is not finite.
    """
    if not (np.isfinite(start).all() and np.isfinite(goal).all()):
        what = "start or goal of a move is not finite"
        raise TrajectoryError(what, value=goal.tolist(), remedy="give finite numbers")
    distance = np.abs(goal - start)
    moved = distance > 0.0
    if not moved.any():
        return JointMove(start, goal, DoubleS(0.0, 0.0, 0.0, 1.0))
    caps = [float(np.min(cap[moved] / distance[moved])) for cap in (velocity, acceleration, jerk)]
    return JointMove(start, goal, double_s(*caps))
