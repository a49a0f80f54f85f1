"""Which leg of the delta slipped behind its load encoder? The tracked tip against the tip of the load encoders.

The delta has three legs for three freedoms: its three lengths close for any reading, so nothing within the delta can
tell that one of them is wrong. Motor against load encoder (`sher3_drivers.joint_checks`) sees what slips before the
load encoder and names its axis. What slips behind it, between load encoder and platform, shows only where something
else measures the tip: an external tracker. Its residual in {b}, taken back through the delta's Jacobian, is a motion
of the three sliders; one leg's slip is a motion of that slider alone, an error of arm, base or tracker one of all.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_description import ACTUATORS
from sher3_kinematics import RobotKinematics

from .detectors import Finding, _Plain
from .modes import Vector
from .reasons import Reason

Array = NDArray[np.float64]
ALONE = 0.5
"""The other two legs' share below which the largest residual is one leg's."""


class LegResidual(NamedTuple):
    """Tip residual as slider motions (3,) [m]; `leg` is the index of the leg that alone explains it, or None."""

    sliders: Array
    leg: int | None


def leg_residual(kinematics: RobotKinematics, q: Vector, displacement: Array) -> LegResidual:
    """Return the slider motions that would displace the tip by `displacement` (3,) [m] in {b} at `q` (5,)."""
    jacobian = kinematics.jacobian(np.asarray(q))[:3, :3]
    sliders = np.linalg.solve(jacobian, displacement)
    size = np.abs(sliders)
    worst = int(size.argmax())
    alone = np.delete(size, worst).max() <= ALONE * size[worst]
    return LegResidual(sliders, worst if alone else None)


class LegDetector(_Plain):
    """Watches the tracked tip where there is a tracker; without one it has nothing to say.

    Args:
        kinematics: of the robot.
        limit: slider motion of one leg [m]; elastic deflection under the surgeon's hand stays below it.
        latency: how long it must last [s].
        memory: time constant with which the slow part is followed [s].
    """

    def __init__(self, kinematics: RobotKinematics, limit: float, latency: float, memory: float) -> None:
        self._kinematics, self._limit, self._latency, self._memory = kinematics, limit, latency, memory
        self._slow: Array | None = None
        self._last = self._since = -1
        self._found = Finding(Reason.LEG_SLIPPED, 0.0, limit, "m", "delta")
        self._held = 0.0

    def feed(self, stamp: int, tip: Vector, q: Vector) -> None:
        """Take a tracked tip position (3,) [m] in {b} and the load encoders (5,) of the same stamp [ns]."""
        off = np.asarray(tip) - self._kinematics.transform_tip_to_base(np.asarray(q))[:3, 3]
        if self._slow is None or not np.isfinite(off).all():
            self._slow, self._last = off, stamp
            return
        step, self._last = (stamp - self._last) * 1e-9, stamp
        residual = leg_residual(self._kinematics, q, off - self._slow)
        self._slow = self._slow + min(1.0, max(0.0, step) / self._memory) * (off - self._slow)
        size = float(np.abs(residual.sliders).max())
        source = "delta" if residual.leg is None else ACTUATORS[residual.leg]
        self._found = Finding(Reason.LEG_SLIPPED, size, self._limit, "m", source)
        if size <= self._limit or residual.leg is None:
            self._since = -1
        elif self._since < 0:
            self._since = stamp

    def look(self, now: int) -> Finding:
        """Return the largest slider motion."""
        return self._found

    def check(self, now: int) -> Finding | None:
        """Object when one leg has been off for longer than the latency."""
        return self._found if self._since >= 0 and (self._last - self._since) * 1e-9 >= self._latency else None

    def recover(self, now: int) -> None:
        """Take the present tip as right."""
        self._slow, self._since = None, -1
