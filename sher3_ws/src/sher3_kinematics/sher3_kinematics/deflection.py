"""Deflection of the delta platform under a wrench: the paper's model, vectorised over poses.

Equation numbers are those of Alamdar et al., "Steady-Hand Eye Robot 3.0: Optimization and Benchtop Evaluation for
Subretinal Injection", IEEE T-MRB 6(1), 2024. Wrenches are (force; moment) [N, N m], deflections (translation; rotation)
[m, rad], both at the platform centre P with the axes of {b}. Leading dimensions are poses and broadcast.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sher3_description import Robot

from sher3_kinematics.errors import BadInput, Singular, Unreachable
from sher3_kinematics.link_law import LinkLaw

Floats = NDArray[np.float64]

LARGEST_CONDITION = 1e6
"""Condition number of the dimensionless gamma matrix beyond which a pose counts as singular."""


def ball_centres(robot: Robot) -> tuple[Floats, Floats]:
    """Return the base ball centres at slider height 0 and the platform ball centres in {p}, both (6, 3) [m].

    Links 2k and 2k + 1 belong to leg k. Both circles are circumscribed about the ball centres, radii r_b and r_p.
    """
    delta = robot.delta
    half = delta.leg_width / 2
    base, platform = np.zeros((6, 3)), np.zeros((6, 3))
    for k, azimuth in enumerate(delta.leg_azimuth):
        outward = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        sideways = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        for side in (0, 1):
            shift = (2 * side - 1) * half * sideways
            base[2 * k + side] = delta.base_distance * outward + shift
            platform[2 * k + side] = delta.platform_distance * outward + shift
    return base, platform


class DeltaDeflection:
    """The delta stage as six elastic links between rigid bodies.

    Attributes:
        law: deflection of one link as a function of its force.
        base, platform: ball centres (6, 3) [m], see `ball_centres`.
        link_length: L [m].
    """

    def __init__(self, robot: Robot, law: LinkLaw | None = None) -> None:
        """Take the geometry from the robot, and the link law too unless one is given."""
        self.law = LinkLaw.of(robot) if law is None else law
        self.base, self.platform = ball_centres(robot)
        self.link_length = robot.delta.link_length

    def link_vectors(self, centre: ArrayLike) -> Floats:
        """Return r_CD (..., 6, 3) [m] from the base ball to the platform ball of each link.

        Args:
            centre: platform centre (..., 3) [m]; its height does not matter, the rails are vertical.

        Raises:
            Unreachable: a link is too short; carries the missing distance [m] of the worst pose.
        """
        point = np.asarray(centre, dtype=float)
        if point.shape[-1:] != (3,) or not np.isfinite(point).all():
            raise BadInput("platform centre", value=point.shape, limit="(..., 3), finite", remedy="give x, y, z")
        across = point[..., None, :2] + (self.platform - self.base)[:, :2]
        square = (across**2).sum(axis=-1)
        if (square >= self.link_length**2).any():
            worst = float(np.sqrt(square.max()))
            what = "a link does not reach across [m]"
            beyond, limit = worst - self.link_length, self.link_length
            raise Unreachable(what, part="delta", distance=beyond, unit="m", value=worst, limit=limit)
        return np.concatenate((across, np.sqrt(self.link_length**2 - square)[..., None]), axis=-1)

    def gamma(self, centre: ArrayLike) -> Floats:
        """Return the matrix of eq. (5), (..., 6, 6), with the columns gamma_i = (r_CD; r_PD x r_CD) of eq. (4)."""
        links = self.link_vectors(centre)
        columns = np.concatenate((links, np.cross(self.platform, links)), axis=-1)
        return np.swapaxes(columns, -1, -2)

    def _inverse_gamma(self, centre: ArrayLike) -> Floats:
        """Return L gamma^-1 (..., 6, 6).

        Raises:
            Singular: the condition number with lengths in units of L exceeds LARGEST_CONDITION.
        """
        gamma = self.gamma(centre)
        scale = np.array([1.0] * 3 + [1.0 / self.link_length] * 3)[:, None]
        condition = np.linalg.cond(scale * gamma / self.link_length)
        if not (condition < LARGEST_CONDITION).all():
            worst = float(np.max(condition))
            raise Singular("delta links (gamma)", distance=1.0 / worst, limit=1.0 / LARGEST_CONDITION)
        return self.link_length * np.linalg.inv(gamma)

    def link_forces(self, centre: ArrayLike, wrench: ArrayLike) -> Floats:
        """Return the axial force of each link (..., 6) [N], tension positive, eq. (6): F = L gamma^-1 wrench."""
        return np.einsum("...ij,...j->...i", self._inverse_gamma(centre), _wrench(wrench))

    def deflection(self, centre: ArrayLike, wrench: ArrayLike) -> Floats:
        """Return the platform's deflection (..., 6) under a wrench (..., 6), eqs. (6), (13) and (12)."""
        inverse = self._inverse_gamma(centre)
        forces = np.einsum("...ij,...j->...i", inverse, _wrench(wrench))
        return np.einsum("...ji,...j->...i", inverse, self.law.deflection(forces))

    def compliance(self, centre: ArrayLike, wrench: ArrayLike, kind: Literal["secant", "tangent"] = "secant") -> Floats:
        """Return the compliance matrix (..., 6, 6) at a wrench (..., 6): L gamma^-T diag(C(F)) L gamma^-1, symmetric.

        `secant` gives the deflection when multiplied by the wrench; `tangent` its change for a small change of it.
        """
        if kind not in ("secant", "tangent"):
            raise BadInput("kind of compliance", value=kind, limit="secant or tangent", remedy="choose one")
        inverse = self._inverse_gamma(centre)
        forces = np.einsum("...ij,...j->...i", inverse, _wrench(wrench))
        links = self.law.secant(forces) if kind == "secant" else self.law.tangent(forces)
        return np.einsum("...ki,...k,...kj->...ij", inverse, links, inverse)

    def torsional_compliance(self, centre: ArrayLike, torque: float) -> Floats:
        """Return T_c = rotation about z / torque (...) [rad/(N m)] under a pure moment about z, eq. (15)."""
        if torque == 0.0:
            raise BadInput("torque [N m]", value=torque, limit="not 0", remedy="give the torque at which to take T_c")
        return self.deflection(centre, [0, 0, 0, 0, 0, torque])[..., 5] / torque

    def parasitic_motion(self, centre: ArrayLike, torque: float) -> tuple[Floats, Floats]:
        """Return what a moment about z moves beside the rotation about z: sizes of translation [m] and tilt [rad]."""
        deflection = self.deflection(centre, [0, 0, 0, 0, 0, torque])
        return np.linalg.norm(deflection[..., :3], axis=-1), np.linalg.norm(deflection[..., 3:5], axis=-1)


def _wrench(wrench: ArrayLike) -> Floats:
    values = np.asarray(wrench, dtype=float)
    if values.shape[-1:] != (6,) or not np.isfinite(values).all():
        remedy = "give force and moment, six finite numbers"
        raise BadInput("wrench", value=values.tolist(), limit="(..., 6), finite", remedy=remedy)
    return values
