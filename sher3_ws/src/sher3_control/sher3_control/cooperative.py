"""The velocity modes in actuator space: a tip twist through J, with or without a remote centre."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_kinematics import InverseVelocity, LimitedVelocity, RobotKinematics
from sher3_kinematics.direct import direct
from sher3_kinematics.inverse_velocity import describe
from sher3_kinematics.kernel_velocity import NOT_FINITE

from .errors import SettingsError
from .limits import ZERO_TWIST
from .modes import Vector
from .rcm import NO_HOLD, Hold, next_hold, rcm_velocity, shaft_deviation
from .reasons import Reason
from .speed_cap import SpeedCap, cap_factor

Array = NDArray[np.float64]

RESTING: Vector = (0.0, 0.0, 0.0, 0.0, 0.0)
_NOT_FINITE = describe(NOT_FINITE)
DEVIATION_LIMIT = 1e-3
"""A shaft further than this [m] from the remote centre is no longer held by it: the robot stops."""
CAPTURE_LIMIT = 1e-4
"""A remote centre is accepted when the shaft passes within this [m]."""


class Velocity(NamedTuple):
    """Actuator velocity (5,), why it is zero, what limited it, and the shaft's distance from the remote centre [m]."""

    velocity: Vector
    reason: Reason
    limited_by: str
    deviation: float


class VelocityModes:
    """Tip twists and actuator velocities, limited; pure functions of their arguments, the remote centre and its hold.

    The hold begins at zero whenever the velocity before was zero, so a robot at rest has no memory.

    Attributes:
        centre: the remote centre (3,) [m] in {b}, or None.
        hold: the law's memory while the robot moves about the centre, see `rcm`.
        cap: speed caps of the tip.
    """

    def __init__(self, kinematics: RobotKinematics, gain: float, integral: float = 0.0) -> None:
        """Take the rates [1/s], [1/s^2] at which a deviation from the centre decays and the hold against it grows."""
        self.kinematics = kinematics
        self.centre: Array | None = None
        self.cap = SpeedCap(math.inf, math.inf)
        self._gain, self._integral = gain, integral
        self.hold: Hold = NO_HOLD
        self._inverse = InverseVelocity(kinematics)
        self._parameters = np.array(kinematics.parameters)
        self._cap_factor = direct(cap_factor, self._parameters, RESTING, RESTING, self.cap)

    def warm_up(self) -> None:
        """Run every compiled part once."""
        shaft_deviation(np.eye(3), np.zeros(3), np.zeros(3))
        self._keeping(np.zeros(5), np.zeros(6), np.zeros(3), NO_HOLD)
        self._inverse(RESTING, (1e-6, 0.0, 0.0, 0.0, 0.0, 0.0), RESTING)

    def set_centre(self, centre: Vector | None, q: Vector) -> None:
        """Set the remote centre [m] in {b}, or leave it with None.

        Raises:
            SettingsError: not finite, or the shaft does not pass through it now.
        """
        if centre is None:
            self.centre = None
            return
        if len(centre) != 3 or not math.isfinite(sum(centre)):
            what = "the remote centre needs three finite coordinates [m]"
            raise SettingsError(what, value=centre, remedy="correct them")
        point = np.array(centre)
        transform = self.kinematics.transform_tip_to_base(q)
        x, y, _ = shaft_deviation(transform[:3, :3], transform[:3, 3], point)
        if math.hypot(x, y) > CAPTURE_LIMIT:
            what = "the shaft passes too far from the remote centre [m]"
            remedy = "move the needle onto it first, or set it with `rcm here DEPTH`"
            raise SettingsError(what, value=math.hypot(x, y), limit=CAPTURE_LIMIT, remedy=remedy)
        self.centre = point

    def centre_behind_tip(self, depth: float, q: Vector) -> Vector:
        """Return the point of the shaft `depth` [m] behind the tip, in {b}."""
        transform = self.kinematics.transform_tip_to_base(q)
        return tuple((transform[:3, 3] + depth * transform[:3, 2]).tolist())

    def from_twist(self, q: Vector, twist: Vector, previous: Vector) -> Velocity:
        """Return the actuator velocity for a tip twist (6,) in {b}; a zero twist is zero velocity at once.

        `q` and `previous` are finite (5,): the motion controller has judged them.
        """
        if twist == ZERO_TWIST:
            return Velocity(RESTING, Reason.MOVING, "", 0.0)
        if not math.isfinite(sum(twist)):
            return Velocity(RESTING, Reason.COMMAND_NOT_FINITE, "", 0.0)
        if self.centre is None:
            q_dot, _, code = self._inverse.of_finite(q, twist, previous)
            if code == NOT_FINITE:
                return Velocity(RESTING, Reason.SINGULAR, "", 0.0)
            return self._capped(q, Velocity(q_dot, Reason.MOVING, describe(code), 0.0))
        return self._capped(q, self._about_centre(q, twist, previous, self.centre))

    def _about_centre(self, q: Vector, twist: Vector, previous: Vector, centre: Array) -> Velocity:
        hold = NO_HOLD if previous == RESTING else self.hold
        joints, request = np.array(q), np.array(twist)
        try:
            wanted, x, y = self._keeping(joints, request, centre, hold)
            limited = self._inverse.limit(joints, wanted, previous)
            if limited.scale < 1.0:
                # The request is scaled, not the correction: scaled with it, a correction would come too late.
                wanted, x, y = self._keeping(joints, limited.scale * request, centre, hold)
                limited = self._inverse.limit(joints, wanted, previous)._replace(limited_by=limited.limited_by)
        except np.linalg.LinAlgError:
            return Velocity(RESTING, Reason.SINGULAR, "", 0.0)
        self.hold, deviation = next_hold(hold, x, y, self._integral, self._inverse.period), math.hypot(x, y)
        if not deviation <= DEVIATION_LIMIT:
            return Velocity(RESTING, Reason.OFF_CENTRE, "", deviation)
        return _velocity(limited, deviation)

    def _keeping(self, q: Array, twist: Array, centre: Array, hold: Hold) -> tuple[Array, float, float]:
        return rcm_velocity(self._parameters, q, twist, centre, hold, self._gain, self._inverse.period)

    def from_joints(self, q: Vector, wanted: Vector, previous: Vector) -> Velocity:
        """Return the permitted part of an actuator velocity (5,)."""
        return self._capped(q, _velocity(self._inverse.limit(q, wanted, previous), 0.0))

    def cap_factor(self, q: Vector, velocity: Vector) -> float:
        """Return by how much an actuator velocity (5,) is to be scaled for the speed caps; 1 or less."""
        return 1.0 if math.isinf(self.cap.linear) else self._cap_factor(self._parameters, q, velocity, self.cap)

    def _capped(self, q: Vector, wanted: Velocity) -> Velocity:
        """Scale a velocity as a whole, so that the tip keeps its direction."""
        factor = self.cap_factor(q, wanted.velocity)
        if factor >= 1.0:
            return wanted
        return wanted._replace(velocity=tuple([factor * v for v in wanted.velocity]), limited_by="tip speed")


def _velocity(limited: LimitedVelocity, deviation: float) -> Velocity:
    if limited.limited_by == _NOT_FINITE:
        return Velocity(RESTING, Reason.SINGULAR, "", deviation)
    return Velocity(tuple(limited.q_dot.tolist()), Reason.MOVING, limited.limited_by, deviation)
