"""The tilt linkage, an offset slider-crank: closed form both ways and its dead points."""

from __future__ import annotations

import math

from sher3_description import Robot

from sher3_kinematics import kernel
from sher3_kinematics.errors import BadInput, Unreachable
from sher3_kinematics.kernel.parameters import KernelParameters, kernel_parameters


class TiltLinkage:
    """The tilt linkage of one robot; q is the slider's displacement [m] from zero tilt.

    Attributes:
        dead_points: tilt angles (lower, upper) [rad] at which crank and coupler are in line, folded and stretched.
        travel: slider displacements (lower, upper) [m] at the dead points.
    """

    def __init__(self, robot: Robot, parameters: KernelParameters | None = None) -> None:
        """Take the linkage from the robot; `parameters` replaces the nominal geometry by another."""
        self.parameters = kernel_parameters(robot) if parameters is None else parameters
        p = self.parameters
        self.dead_points = (-self._angle_in_line(p.crank - p.coupler), self._angle_in_line(p.crank + p.coupler))
        self.travel = (kernel.tilt_slider(p, self.dead_points[0]), kernel.tilt_slider(p, self.dead_points[1]))

    def _angle_in_line(self, reach: float) -> float:
        """Return the crank angle [rad] with crank and coupler in line; `reach` [m] is their signed sum of lengths."""
        cosine = self.parameters.offset / reach
        return math.acos(cosine) if abs(cosine) <= 1.0 else math.pi

    def angle(self, q: float) -> float:
        """Return the tilt angle [rad] for the slider displacement q [m].

        Raises:
            Unreachable: q is beyond a dead point; carries the distance [m].
        """
        if not math.isfinite(q):
            raise BadInput("tilt slider displacement is not finite", value=q, remedy="check its source")
        angle = kernel.tilt_angle(self.parameters, q)
        if math.isnan(angle) or not self.travel[0] <= q <= self.travel[1]:
            raise self._beyond(q, self.travel, "slider displacement [m]", "m")
        return angle

    def slider(self, angle: float) -> float:
        """Return the slider displacement [m] for the tilt angle [rad].

        Raises:
            Unreachable: the angle is beyond a dead point; carries the distance [rad].
        """
        if not math.isfinite(angle):
            raise BadInput("tilt angle is not finite", value=angle, remedy="check its source")
        if not self.dead_points[0] <= angle <= self.dead_points[1]:
            raise self._beyond(angle, self.dead_points, "tilt angle [rad]", "rad")
        return kernel.tilt_slider(self.parameters, angle)

    def ratio(self, angle: float) -> float:
        """Return d slider / d angle [m/rad] at the tilt angle [rad]; zero at the dead points."""
        return kernel.tilt_ratio(self.parameters, angle)

    def _beyond(self, value: float, ends: tuple[float, float], what: str, unit: str) -> Unreachable:
        limit = f"{ends[0]:.6g} to {ends[1]:.6g}"
        distance = max(ends[0] - value, value - ends[1])
        what = f"{what} is beyond a dead point"
        return Unreachable(what, part="tilt", distance=distance, unit=unit, value=value, limit=limit)
