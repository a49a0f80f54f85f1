"""A straight move of the tip while the tool turns about one fixed axis, as a timed curve in actuator space."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_kinematics import RobotKinematics

from sher3_control.motion.planned.spline import Spline, spline_through
from sher3_control.motion.planned.trajectory import DoubleS, double_s

Array = NDArray[np.float64]

NODES = 65
"""Poses at which the path is inverted and checked; the spline between them is off by nanometres (see the tests)."""
STILL = 1e-12
"""An axis whose slope along the path is no greater than this [m or rad], which is rounding, does not move."""
STRAIGHT = 1e-9
"""Below this angle [rad] a straight line between two directions is as good as the great circle, whose formula fails."""
CURVATURE_SHARE = 0.5
"""Share of each axis' acceleration that is kept for the curvature of the path, q'' ds^2; speeding up has the rest."""


@dataclass(frozen=True)
class TipMove:
    """A planned move of the tip.

    Attributes:
        path: curve q(s) in actuator space, (5,) for s from 0 to 1.
        profile: s over time.
    """

    path: Spline
    profile: DoubleS

    @property
    def duration(self) -> float:
        """Length of the motion [s]."""
        return self.profile.duration

    def at(self, t: float) -> tuple[Array, Array]:
        """Return reference positions (5,) and velocities (5,) at `t` [s] after the start."""
        s, rate = self.profile.at(t)
        return self.path(s), rate * self.path(s, 1)


def plan_tip_move(
    kinematics: RobotKinematics,
    start: Array,
    position: Array,
    axis: Array,
    caps: tuple[Array, Array, Array],
    linear_speed: float,
    angular_speed: float,
) -> TipMove:
    """Plan a straight move of the tip to a position and a direction of the needle, in {b}.

    Args:
        kinematics: of the robot.
        start: actuator positions (5,).
        position: goal of the tip (3,) [m].
        axis: direction of the needle at the goal (3,), of any length.
        caps: velocity, acceleration and jerk of the actuators, (5,) each.
        linear_speed: cap of the tip's speed [m/s].
        angular_speed: cap of the needle's turning [rad/s].

    Raises:
        Unreachable, OutsideLimits: the goal or a pose on the path is out of reach.
    """
    transform = kinematics.transform_tip_to_base(start)
    begin, toward = transform[:3, 3], -transform[:3, 2]
    axis = axis / np.linalg.norm(axis)
    angle = math.atan2(float(np.linalg.norm(np.cross(toward, axis))), float(toward @ axis))
    s = np.linspace(0.0, 1.0, NODES)
    nodes = np.array([kinematics.inverse(begin + k * (position - begin), _turn(toward, axis, angle, k)) for k in s])
    path = spline_through(nodes)
    first, second = np.abs(path(s, 1)).max(axis=0), np.abs(path(s, 2)).max(axis=0)
    velocity, acceleration, jerk = caps
    rate = _least(velocity, first)
    rate = min(rate, *_speed_caps(linear_speed, np.linalg.norm(position - begin), angular_speed, angle))
    rate = min(rate, math.sqrt(_least(CURVATURE_SHARE * acceleration, second)))
    if not math.isfinite(rate):
        return TipMove(path, DoubleS(0.0, 0.0, 0.0, 1.0))
    profile = double_s(
        rate, _least((1.0 - CURVATURE_SHARE) * acceleration, first), _least((1.0 - CURVATURE_SHARE) * jerk, first)
    )
    return TipMove(path, profile)


def _least(cap: Array, slope: Array) -> float:
    """Return the smallest ratio cap / slope over the axes that move, infinite where none does."""
    moved = slope > STILL
    return float(np.min(cap[moved] / slope[moved])) if moved.any() else math.inf


def _speed_caps(linear: float, distance: Any, angular: float, angle: float) -> tuple[float, float]:
    """Return the rates of s [1/s] at which the tip reaches its linear and its angular cap."""
    return (linear / float(distance) if distance > 0.0 else math.inf, angular / angle if angle > 0.0 else math.inf)


def _turn(a: Array, b: Array, angle: float, k: float) -> Array:
    """Return the direction at the fraction `k` of the great circle from `a` to `b`, which are `angle` [rad] apart."""
    if angle < STRAIGHT:
        return a + k * (b - a)
    return (math.sin((1.0 - k) * angle) * a + math.sin(k * angle) * b) / math.sin(angle)
