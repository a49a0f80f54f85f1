"""Velocities in actuator space: from a tip twist through the Jacobian, with or without a remote centre."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import direct
from sher3_common.reasons import Reason
from sher3_common.vectors import ZERO_TWIST, Vector
from sher3_kinematics import InverseVelocity, LimitedVelocity, RobotKinematics
from sher3_kinematics.inverse_velocity import describe
from sher3_kinematics.kernel.velocity import NOT_FINITE

from sher3_control.errors import SettingsError
from sher3_control.motion.rcm import NO_HOLD, Hold, next_hold, rcm_velocity, shaft_deviation
from sher3_control.motion.speed_cap import SpeedCap, cap_factor

Array = NDArray[np.float64]

RESTING: Vector = (0.0, 0.0, 0.0, 0.0, 0.0)
"""No velocity of any actuator."""
_NOT_FINITE = describe(NOT_FINITE)
DEVIATION_LIMIT = 1e-3
"""The robot stops when the shaft is further than this [m] from the remote centre: it no longer pivots about it."""
CAPTURE_LIMIT = 1e-4
"""A remote centre is accepted when the shaft passes within this distance [m]."""


class Velocity(NamedTuple):
    """An actuator velocity and its circumstances.

    Attributes:
        velocity: (5,) m/s and rad/s.
        reason: why it is zero, MOVING otherwise.
        limited_by: what limited it, empty for nothing.
        deviation: distance of the shaft from the remote centre [m], 0 without one.
    """

    velocity: Vector
    reason: Reason
    limited_by: str
    deviation: float


class VelocityModes:
    """Actuator velocities within all limits, from tip twists and from wanted actuator velocities.

    The results depend on the arguments, the remote centre and its hold alone. The hold begins at zero whenever the
    velocity before was zero, so a robot at rest has no memory.

    Args:
        kinematics: of the robot.
        gain: rate at which a deviation from the remote centre decays [1/s].
        integral: rate at which the hold against a deviation grows [1/s^2].

    Attributes:
        kinematics: of the robot.
        centre: the remote centre (3,) [m] in {b}, or None.
        hold: the law's memory while the robot moves about the centre, see `rcm`.
        cap: speed caps of the tip.
        axis_caps: speed caps of the actuators (5,).
    """

    def __init__(self, kinematics: RobotKinematics, gain: float, integral: float = 0.0) -> None:
        self.kinematics = kinematics
        self.centre: Array | None = None
        self.cap = SpeedCap(math.inf, math.inf)
        self.axis_caps: Vector = tuple(kinematics.velocity.tolist())
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
        """Set the remote centre [m] in {b} with the robot at `q` (5,); None ends the constraint.

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
            remedy = "move the needle onto it first, or send `here DEPTH`"
            raise SettingsError(what, value=math.hypot(x, y), limit=CAPTURE_LIMIT, remedy=remedy)
        self.centre = point

    def centre_behind_tip(self, depth: float, q: Vector) -> Vector:
        """Return the point (3,) of the shaft `depth` [m] behind the tip, in {b}, with the robot at `q` (5,)."""
        transform = self.kinematics.transform_tip_to_base(q)
        return tuple((transform[:3, 3] + depth * transform[:3, 2]).tolist())

    def from_twist(self, q: Vector, twist: Vector, previous: Vector) -> Velocity:
        """Return the actuator velocity for a tip twist; a zero twist gives zero velocity at once.

        Args:
            q: measured positions (5,); the caller has checked that they are finite.
            twist: of the tip (6,) in {b} [m/s], [rad/s].
            previous: velocity commanded last (5,), finite.
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
                # Only the request is scaled. Scaled with it, the correction would let the shaft drift away.
                wanted, x, y = self._keeping(joints, limited.scale * request, centre, hold)
                limited = self._inverse.limit(joints, wanted, previous)._replace(limited_by=limited.limited_by)
        except np.linalg.LinAlgError:
            return Velocity(RESTING, Reason.SINGULAR, "", 0.0)
        self.hold = next_hold(hold, x, y, self._integral, self._inverse.period)
        deviation = math.hypot(x, y)
        if not deviation <= DEVIATION_LIMIT:
            return Velocity(RESTING, Reason.OFF_CENTRE, "", deviation)
        return _velocity(limited, deviation)

    def _keeping(self, q: Array, twist: Array, centre: Array, hold: Hold) -> tuple[Array, float, float]:
        return rcm_velocity(self._parameters, q, twist, centre, hold, self._gain, self._inverse.period)

    def from_joints(self, q: Vector, wanted: Vector, previous: Vector) -> Velocity:
        """Return the permitted part of an actuator velocity `wanted` (5,) at `q` (5,), after `previous` (5,)."""
        return self._capped(q, _velocity(self._inverse.limit(q, wanted, previous), 0.0))

    def cap_factor(self, q: Vector, velocity: Vector) -> float:
        """Return the factor, 1 or less, that brings an actuator velocity (5,) at `q` (5,) within the speed caps."""
        if math.isinf(self.cap.linear):
            return 1.0
        factor = self._cap_factor(self._parameters, q, velocity, self.cap)
        for value, cap in zip(velocity, self.axis_caps, strict=True):
            if abs(value) * factor > cap:
                factor = cap / abs(value)
        return factor

    def _capped(self, q: Vector, wanted: Velocity) -> Velocity:
        """Return the velocity scaled as a whole to the speed caps, so that the tip keeps its direction."""
        factor = self.cap_factor(q, wanted.velocity)
        if factor >= 1.0:
            return wanted
        return wanted._replace(velocity=tuple([factor * v for v in wanted.velocity]), limited_by="tip speed")


def _velocity(limited: LimitedVelocity, deviation: float) -> Velocity:
    if limited.limited_by == _NOT_FINITE:
        return Velocity(RESTING, Reason.SINGULAR, "", deviation)
    return Velocity(tuple(limited.q_dot.tolist()), Reason.MOVING, limited.limited_by, deviation)
