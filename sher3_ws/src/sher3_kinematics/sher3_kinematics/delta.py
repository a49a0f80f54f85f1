"""The linear delta stage: forward and inverse kinematics, reach, joint swing and workspace."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from sher3_description import ACTUATORS, Robot

from sher3_kinematics import arrays
from sher3_kinematics.arrays import Floats, rows, vector
from sher3_kinematics.errors import BadInput, Unreachable
from sher3_kinematics.kernel import batch as kernel_batch
from sher3_kinematics.kernel import reach as kernel_reach
from sher3_kinematics.kernel.parameters import KernelParameters, kernel_parameters

LEAST_ELEVATION = 0.1
"""Least sine of a leg's elevation in the workspace: there a slider moves at most ten times as fast as the platform."""


class Delta:
    """The delta stage of one robot.

    Attributes:
        leg_offset: R [m], horizontal distance of the two ball pairs of a leg at the centre; from the circumradii
            r_b and r_p and the leg width w, R = sqrt(r_b^2 - w^2/4) - sqrt(r_p^2 - w^2/4).
        reach: largest distance [m] from the axis at which all three legs still reach in every direction, L - R.
        lower, upper: slider travel (3,) [m].
        least_elevation: least sine of the leg elevation inside the workspace.
    """

    def __init__(
        self, robot: Robot, parameters: KernelParameters | None = None, least_elevation: float = LEAST_ELEVATION
    ) -> None:
        """Take geometry and travel from the robot; `parameters` replaces the nominal geometry by another."""
        if not 0.0 <= least_elevation < 1.0:
            raise BadInput("least_elevation", value=least_elevation, limit="0 to 1", remedy="give the sine of an angle")
        self.parameters = kernel_parameters(robot) if parameters is None else parameters
        self.leg_offset = robot.delta.leg_offset
        self.reach = robot.delta.link_length - self.leg_offset
        self.lower = np.array([actuator.limits.lower for actuator in robot.actuators[:3]])
        self.upper = np.array([actuator.limits.upper for actuator in robot.actuators[:3]])
        self.least_elevation = least_elevation
        self._values = np.array(self.parameters)

    def forward(self, q: Sequence[float] | Floats) -> Floats:
        """Return the platform centre (3,) [m] in {b} for slider positions (3,) [m], upper root.

        Raises:
            Unreachable: the three legs do not meet.
        """
        sliders = vector(q, 3, "slider positions")
        centre = arrays.delta_forward(self._values, sliders)
        if math.isnan(centre[2]):
            raise self._do_not_meet(sliders)
        return centre

    def inverse(self, centre: Sequence[float] | Floats) -> Floats:
        """Return the slider positions (3,) [m] for a platform centre (3,) [m] in {b}, travel not considered.

        Raises:
            Unreachable: a leg is too short; carries the missing distance [m].
        """
        point = vector(centre, 3, "platform centre")
        q = arrays.delta_inverse(self._values, point)
        if np.isnan(q).any():
            beyond = self._edge_distances(point, np.full(3, -np.inf), np.full(3, np.inf), 0.0)
            leg = int(np.argmin(beyond))
            raise self._unreachable(leg, float(-beyond[leg]), point)
        return q

    def jacobian(self, q: Sequence[float] | Floats) -> Floats:
        """Return d platform centre / d slider positions (3, 3) at slider positions (3,) [m]."""
        return arrays.delta_jacobian(self._values, vector(q, 3, "slider positions"))

    def edge_distance(self, centre: Sequence[float] | Floats) -> float:
        """Return the distance [m] of a platform centre (3,) to the edge of the workspace, negative outside.

        The workspace is where every slider is within its travel and every leg at least `least_elevation` steep.
        Inside the distance is exact; outside its magnitude is a lower bound of the distance.
        """
        point = vector(centre, 3, "platform centre")
        return float(self._edge_distances(point, self.lower, self.upper, self.least_elevation).min())

    def contains(self, centre: Sequence[float] | Floats) -> bool:
        """Return whether a platform centre (3,) [m] lies in the workspace."""
        return self.edge_distance(centre) >= 0.0

    def require(self, centre: Sequence[float] | Floats) -> None:
        """Raise Unreachable, with the distance beyond the edge, unless the workspace holds the centre (3,) [m]."""
        point = vector(centre, 3, "platform centre")
        distances = self._edge_distances(point, self.lower, self.upper, self.least_elevation)
        leg = int(np.argmin(distances))
        if distances[leg] < 0.0:
            raise self._unreachable(leg, float(-distances[leg]), point)

    def swing(self, centre: Sequence[float] | Floats, axis: Sequence[Sequence[float]] | Floats | None = None) -> Floats:
        """Return the angle (3,) [rad] of each leg from a reference direction at a platform centre (3,) [m].

        Args:
            centre: platform centre in {b}.
            axis: socket directions (3, 3), one row per leg; by default the leg directions at all sliders zero.
        """
        point = vector(centre, 3, "platform centre")
        self.inverse(point)
        directions = np.empty((3, 3))
        kernel_reach.leg_directions_into(self.parameters, point[0], point[1], point[2], directions)
        if axis is None:
            home, reference = self.forward(np.zeros(3)), np.empty((3, 3))
            kernel_reach.leg_directions_into(self.parameters, home[0], home[1], home[2], reference)
        else:
            reference = rows(axis, 3, "socket directions")
            reference = reference / np.linalg.norm(reference, axis=1, keepdims=True)
        across = np.linalg.norm(np.cross(directions, reference), axis=1)
        return np.arctan2(across, np.einsum("ij,ij->i", directions, reference))

    def forward_batch(self, q: Floats) -> Floats:
        """Return platform centres (n, 3) [m] for slider positions (n, 3) [m]; NaN where the legs do not meet."""
        return kernel_batch.delta_forward_batch(self.parameters, rows(q, 3, "slider positions"))

    def inverse_batch(self, centres: Floats) -> Floats:
        """Return slider positions (n, 3) [m] for platform centres (n, 3) [m]; NaN out of reach."""
        return kernel_batch.delta_inverse_batch(self.parameters, rows(centres, 3, "platform centres"))

    def _edge_distances(self, point: Floats, lower: Floats, upper: Floats, elevation: float) -> Floats:
        distances = np.empty(3)
        x, y, z = point
        kernel_reach.delta_edge_distances_into(self.parameters, x, y, z, lower, upper, elevation, distances)
        return distances

    def _do_not_meet(self, sliders: Floats) -> Unreachable:
        """Return the error for slider positions that no platform centre fits, with the height that is missing [m]."""
        mean, meets, fails = sliders.mean(), 0.0, 1.0
        for _ in range(50):
            middle = 0.5 * (meets + fails)
            found = arrays.delta_forward(self._values, mean + middle * (sliders - mean))
            meets, fails = (meets, middle) if np.isnan(found).any() else (middle, fails)
        distance = float((1.0 - meets) * np.ptp(sliders))
        what = "the legs do not meet; the slider heights differ by too much [m]"
        value, limit = float(np.ptp(sliders)), float(meets * np.ptp(sliders))
        return Unreachable(what, part="delta", distance=distance, unit="m", value=value, limit=limit)

    def _unreachable(self, leg: int, distance: float, point: Floats) -> Unreachable:
        where = ", ".join(f"{value:.6g}" for value in point)
        return Unreachable(
            "the platform centre [m] is outside the workspace",
            part=ACTUATORS[leg],
            distance=distance,
            unit="m",
            value=f"({where})",
            limit=f"{distance:.6g} m nearer",
        )
