"""The axial deflection of one delta link as a function of its force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sher3_description import Robot

from sher3_kinematics.errors import BadInput

Floats = NDArray[np.float64]

FORCE_FLOOR = 0.5
"""Force [N] below which the power law is replaced by a linear one; its slope at zero would be infinite otherwise."""


@dataclass(frozen=True)
class LinkLaw:
    """dL = factor a F (F^2 + floor^2)^((b - 1) / 2): the paper's dL = a |F|^b, made odd in F and linear near zero.

    At |F| >> floor this is the power law (3.2 % below it at 1 N, 0.4 % at 3 N, for the default floor and b = 0.71); at
    zero its slope is factor a floor^(b - 1). With b = 1 the law is linear and the floor has no effect.

    Attributes:
        a: deflection at 1 N [m/N^b].
        b: exponent.
        factor: compliance with pre-loading springs over that without.
        force_floor: width of the linear range [N]; 0 gives the pure power law, singular at zero force for b < 1.
    """

    a: float
    b: float
    factor: float = 1.0
    force_floor: float = FORCE_FLOOR

    def __post_init__(self) -> None:
        if not (self.a > 0 and self.b > 0 and self.factor > 0 and self.force_floor >= 0):
            value = (self.a, self.b, self.factor, self.force_floor)
            limit = "a, b, factor > 0 and force_floor >= 0"
            raise BadInput("link law (a, b, factor, force_floor)", value=value, limit=limit, remedy="correct it")

    @classmethod
    def of(cls, robot: Robot, springs: bool = True, force_floor: float = FORCE_FLOOR) -> LinkLaw:
        """Return the law in the robot file, with or without the pre-loading springs of the real robot."""
        delta = robot.delta
        factor = delta.spring_factor if springs else 1.0
        return cls(delta.link_compliance.a, delta.link_compliance.b, factor, force_floor)

    def deflection(self, force: ArrayLike) -> Floats:
        """Return the elongation [m] for axial forces [N], tension positive; any shape."""
        f = np.asarray(force, dtype=float)
        return self.secant(f) * f

    def secant(self, force: ArrayLike) -> Floats:
        """Return the secant compliance dL / F [m/N], C(F) of the paper's eq. (13); any shape."""
        f = np.asarray(force, dtype=float)
        with np.errstate(divide="ignore"):
            return self.factor * self.a * (f * f + self.force_floor**2) ** ((self.b - 1.0) / 2.0)

    def tangent(self, force: ArrayLike) -> Floats:
        """Return the tangent compliance d(dL) / dF [m/N]; any shape."""
        f = np.asarray(force, dtype=float)
        square = f * f + self.force_floor**2
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.secant(f) * (1.0 + (self.b - 1.0) * np.where(square > 0, f * f / square, 1.0))
