"""Kinematics of the whole robot: tip pose, Jacobian, closed-form pose inverse, limits and distance to singularity."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from sher3_description import ACTUATORS, Robot, load_robot

from sher3_kinematics import arrays
from sher3_kinematics.arrays import Floats, is_plain, rows, vector
from sher3_kinematics.delta import Delta
from sher3_kinematics.errors import BadInput, OutsideLimits, Unreachable
from sher3_kinematics.kernel import batch as kernel_batch
from sher3_kinematics.kernel import reach as kernel_reach
from sher3_kinematics.kernel.parameters import KernelParameters, kernel_parameters
from sher3_kinematics.tilt_linkage import TiltLinkage

TOLERANCE = 1e-12
"""Slack [m, rad] of the travel limits, so that rounding does not put a position at a limit out of reach."""
SHORTEST_AXIS = 1e-150
"""Length of a tool axis below which its square underflows and it has no direction."""


class SingularityDistance(NamedTuple):
    """The nearest singularity: dimensionless `distance` (0 at it, at most 1) and the `part` that it belongs to."""

    distance: float
    part: str


class RobotKinematics:
    """Kinematics of one robot; q (5,) is in the order delta_1 delta_2 delta_3 roll tilt [m, m, m, rad, m].

    Attributes:
        parameters: the geometry as a flat tuple, for compiled code.
        lower, upper, velocity, acceleration: actuator limits (5,).
        delta, tilt_linkage: the two mechanisms.
    """

    def __init__(self, robot: Robot | None = None, parameters: KernelParameters | None = None) -> None:
        """Take everything from the robot (nominal by default); `parameters` replaces the nominal geometry."""
        self.robot = load_robot() if robot is None else robot
        self.parameters = kernel_parameters(self.robot) if parameters is None else parameters
        limits = [actuator.limits for actuator in self.robot.actuators]
        self.lower = np.array([limit.lower for limit in limits])
        self.upper = np.array([limit.upper for limit in limits])
        self.velocity = np.array([limit.velocity for limit in limits])
        self.acceleration = np.array([limit.acceleration for limit in limits])
        self.delta = Delta(self.robot, self.parameters)
        self.tilt_linkage = TiltLinkage(self.robot, self.parameters)
        self._values = np.array(self.parameters)
        self._lower, self._upper = self.lower - TOLERANCE, self.upper + TOLERANCE
        self._bounded = np.array([*self._values, *self._lower, *self._upper, self.delta.least_elevation])

    def transform_tip_to_base(self, q: Sequence[float] | Floats) -> Floats:
        """Return T_bt (4, 4), recorded-run contract version 1, section 2.

        Raises:
            BadInput: q is not five finite numbers.
            Unreachable: the legs do not meet or the tilt slider is beyond a dead point.
        """
        positions = q if is_plain(q, 5) else vector(q, 5, "actuator positions")
        transform: Floats = arrays.entry("tip_transform")(self._values, positions)
        if math.isnan(transform[2, 3]):
            positions = vector(q, 5, "actuator positions")
            self.delta.forward(positions[:3])
            self.tilt_linkage.angle(float(positions[4]))
        return transform

    def jacobian(self, q: Sequence[float] | Floats) -> Floats:
        """Return the Jacobian (6, 5) from actuator velocities to the tip twist (linear; angular) in {b} at the tip."""
        jacobian: Floats = arrays.entry("tip_jacobian")(self._values, vector(q, 5, "actuator positions"))
        return jacobian

    def gravity_load(self, q: Sequence[float] | Floats) -> Floats:
        """Return the effort (5,) [N, N m] that holds the robot against gravity, contract section 3."""
        return arrays.gravity_load(self._values, vector(q, 5, "actuator positions"))

    def inverse(self, position: Sequence[float] | Floats, axis: Sequence[float] | Floats) -> Floats:
        """Return q (5,) that brings the tip to a position and the tool to a direction, in closed form.

        Args:
            position: tip position (3,) [m] in {b}.
            axis: direction (3,) in {b} in which the needle points, -z of {t}; need not have unit length.

        Raises:
            BadInput: wrong shape, not finite, or an axis without length.
            Unreachable: roll or tilt beyond its travel (distance in rad), or platform outside its workspace (in m).
        """
        point = position if is_plain(position, 3) else vector(position, 3, "tip position")
        direction = axis if is_plain(axis, 3) else vector(axis, 3, "tool axis")
        q: Floats
        q, inside = arrays.entry("pose_inverse")(self._bounded, point, direction)
        if not inside:
            point, direction = vector(position, 3, "tip position"), vector(axis, 3, "tool axis")
            length = math.hypot(*direction)
            if length < SHORTEST_AXIS:
                remedy = "give a unit vector"
                raise BadInput("tool axis has no direction", value=length, limit=f">= {SHORTEST_AXIS}", remedy=remedy)
            self._require_angles(q, direction / length)
            self.delta.require(self._platform_centre(point, q))
            self.require_within_limits(q)
        return q

    def _require_angles(self, q: Floats, axis: Floats) -> None:
        """Refuse roll or tilt angles beyond the travel of the actuators.

        The error tells the angles: the caller gave a direction and knows nothing of slider positions.
        """
        low, high = (self.tilt_linkage.angle(float(end)) for end in (self.lower[4], self.upper[4]))
        if not self._lower[4] <= q[4] <= self._upper[4]:
            raise self._angle_error("tilt", math.asin(max(-1.0, min(1.0, -axis[0]))), low, high)
        zero = self.parameters.zero_4
        if not self._lower[3] <= q[3] <= self._upper[3]:
            raise self._angle_error("roll", q[3] + zero, self.lower[3] + zero, self.upper[3] + zero)

    def _angle_error(self, part: str, angle: float, low: float, high: float) -> Unreachable:
        distance, limit = max(low - angle, angle - high), f"{low:.6g} to {high:.6g}"
        what = "the tool axis asks for an angle [rad] beyond travel"
        return Unreachable(what, part=part, distance=float(distance), unit="rad", value=float(angle), limit=limit)

    def _platform_centre(self, point: Floats, q: Floats) -> Floats:
        """Return the platform centre (3,) [m] for which the tip is at `point` with the roll and tilt of q."""
        reference = np.concatenate((np.zeros(3), q[3:]))
        offset = arrays.tip_transform(self._values, reference)[:3, 3] - self.delta.forward(np.zeros(3))
        return point - offset

    def require_within_limits(self, q: Sequence[float] | Floats) -> None:
        """Raise OutsideLimits for the first actuator position of q (5,) beyond its travel."""
        for k, value in enumerate(vector(q, 5, "actuator positions")):
            if not self._lower[k] <= value <= self._upper[k]:
                unit = "rad" if k == 3 else "m"
                lower, upper = float(self.lower[k]), float(self.upper[k])
                raise OutsideLimits(ACTUATORS[k], value=float(value), lower=lower, upper=upper, unit=unit)

    def singularity_distance(self, q: Sequence[float] | Floats) -> SingularityDistance:
        """Return the nearest singularity of the actuator Jacobian at q (5,).

        The Jacobian is block triangular, so it is singular only where the delta or the tilt linkage is; see
        `kernel.reach.singularity_margins_into` for the five measures.
        """
        margins = np.empty(5)
        kernel_reach.singularity_margins_into(self.parameters, vector(q, 5, "actuator positions"), margins)
        nearest = int(np.nanargmin(margins)) if not np.isnan(margins).all() else 3
        part = (*ACTUATORS[:3], "delta", "tilt")[nearest]
        distance = float(margins[nearest])
        return SingularityDistance(0.0 if np.isnan(margins).any() else max(distance, 0.0), part)

    def transform_tip_to_base_batch(self, q: Floats) -> tuple[Floats, Floats]:
        """Return tip rotations (n, 3, 3) and positions (n, 3) [m] for q (n, 5); NaN where there is no pose."""
        return kernel_batch.tip_pose_batch(self.parameters, rows(q, 5, "actuator positions"))

    def jacobian_batch(self, q: Floats) -> Floats:
        """Return Jacobians (n, 6, 5) for q (n, 5)."""
        return kernel_batch.tip_jacobian_batch(self.parameters, rows(q, 5, "actuator positions"))

    def inverse_batch(self, positions: Floats, axes: Floats) -> Floats:
        """Return q (n, 5) for tip positions (n, 3) [m] and tool axes (n, 3), travel ignored; NaN out of reach."""
        points, directions = rows(positions, 3, "tip positions"), rows(axes, 3, "tool axes")
        if len(points) != len(directions):
            remedy = "give one axis per position"
            raise BadInput(
                "positions and axes differ in number", value=len(directions), limit=len(points), remedy=remedy
            )
        return kernel_batch.pose_inverse_batch(self.parameters, points, directions)
