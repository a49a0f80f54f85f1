"""Which leg of the delta has slipped behind its load encoder: the tracked tip against the tip of the load encoders.

The delta has three legs for three freedoms. Its lengths close for any three readings, so nothing within the delta can
tell that one reading is wrong. A comparison of motor and load encoder (`sher3_drivers.watches.joints`) sees what slips
before the load encoder, and names the axis. What slips behind it, between load encoder and platform, shows only where
something else measures the tip, such as an external tracker.

The residual of the tip in {b}, taken back through the Jacobian of the delta, is a motion of the three sliders. When
one leg slips, it is a motion of one slider alone; an error of arm, base or tracker moves all of them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_common.reasons import Reason
from sher3_common.stamps import seconds
from sher3_common.vectors import Vector
from sher3_description import ACTUATORS
from sher3_kinematics import RobotKinematics

from sher3_control.settings import SupervisorSettings
from sher3_control.supervision.detectors import Finding, PlainDetector

Array = NDArray[np.float64]
ALONE = 0.5
"""One leg has slipped when the other two move by no more than this share of the largest motion."""


class LegResidual(NamedTuple):
    """The residual of the tip as a motion of the sliders.

    Attributes:
        sliders: (3,) [m].
        leg: index of the leg that explains the residual alone, or None.
    """

    sliders: Array
    leg: int | None


def leg_residual(kinematics: RobotKinematics, q: Vector, displacement: Array) -> LegResidual:
    """Return the motion of the sliders that displaces the tip by `displacement` (3,) [m] in {b} at `q` (5,)."""
    jacobian = kinematics.jacobian(np.asarray(q))[:3, :3]
    sliders = np.linalg.solve(jacobian, displacement)
    size = np.abs(sliders)
    worst = int(size.argmax())
    alone = np.delete(size, worst).max() <= ALONE * size[worst]
    return LegResidual(sliders, worst if alone else None)


class LegDetector(PlainDetector):
    """Watches the tracked tip where there is a tracker; without one it never objects.

    Args:
        kinematics: of the robot.
        settings: `leg_distance`, `leg_latency`, `leg_memory`.
    """

    def __init__(self, kinematics: RobotKinematics, settings: SupervisorSettings) -> None:
        self._kinematics = kinematics
        self._limit, self._latency = settings.leg_distance, settings.leg_latency
        self._memory = settings.leg_memory
        self._slow: Array | None = None
        self._last = self._since = -1
        self._found = Finding(Reason.LEG_SLIPPED, 0.0, self._limit, "m", "delta")

    def feed(self, stamp: int, tip: Vector, q: Vector) -> None:
        """Take a tracked position of the tip (3,) [m] in {b}, and the load encoders (5,) of the same stamp [ns]."""
        off = np.asarray(tip) - self._kinematics.transform_tip_to_base(np.asarray(q))[:3, 3]
        if self._slow is None or not np.isfinite(off).all():
            self._slow, self._last = off, stamp
            return
        step, self._last = seconds(stamp - self._last), stamp
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
        """Return the largest motion of a slider."""
        return self._found

    def check(self, now: int) -> Finding | None:
        """Object when one leg has been off for longer than the latency."""
        lasts = self._since >= 0 and seconds(self._last - self._since) >= self._latency
        return self._found if lasts else None

    def recover(self, now: int) -> None:
        """Take the tip as it is now for right."""
        self._slow, self._since = None, -1
