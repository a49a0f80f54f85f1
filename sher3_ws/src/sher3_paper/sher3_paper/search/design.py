"""The delta design of the paper: three parameters and what follows from them, in both readings of the radii.

The paper computes r_b = r_p + L sin(psi). Read as radii to the mid-plane of a leg, the horizontal leg offset is
R = L sin(psi); read as circumradii, through the ball centres, as its formula for r_p demands, it is
R = sqrt(r_b^2 - w^2/4) - sqrt(r_p^2 - w^2/4). Only the second gives the printed conditioning index.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sher3_description import Robot, load_robot

from sher3_paper.errors import InfeasibleDesign

Floats = NDArray[np.float64]
Reading = Literal["circumradius", "midplane"]
READINGS: tuple[Reading, ...] = ("circumradius", "midplane")

JOINT_RADIUS = 0.0125
"""Radius r_SR [m] of a spherical joint, which the paper does not print. Its two designs imply 12.46 to 12.57 mm and
12.35 to 12.45 mm within rounding. These ranges do not overlap, so no single value fits both; 12.5 mm reproduces the
chosen design."""


def platform_radius(leg_width: ArrayLike, joint_radius: float = JOINT_RADIUS) -> Floats:
    """Return the least platform radius [m] that holds six spherical joints, eq. (14)."""
    w = np.asarray(leg_width, dtype=float)
    return np.sqrt(4 * joint_radius**2 + 2 * w * joint_radius + w**2) / np.sqrt(3.0)


def base_radius(link_length: ArrayLike, leg_width: ArrayLike, inclination: ArrayLike) -> Floats:
    """Return r_b = r_p + L sin(psi) [m]."""
    return platform_radius(leg_width) + np.asarray(link_length) * np.sin(inclination)


def leg_offset(
    link_length: ArrayLike, leg_width: ArrayLike, inclination: ArrayLike, reading: Reading = "circumradius"
) -> Floats:
    """Return the horizontal offset R [m] between the ball pairs of a leg at the centre, in either reading."""
    if reading == "midplane":
        return np.asarray(link_length) * np.sin(inclination)
    half = np.asarray(leg_width) / 2
    outer = base_radius(link_length, leg_width, inclination)
    return np.sqrt(outer**2 - half**2) - np.sqrt(platform_radius(leg_width) ** 2 - half**2)


@dataclass(frozen=True)
class Design:
    """One delta stage.

    Attributes:
        link_length: L [m].
        leg_width: w [m], between the two links of a leg.
        inclination: psi [rad], the paper's offset angle.
    """

    link_length: float
    leg_width: float
    inclination: float

    def __post_init__(self) -> None:
        if not (self.link_length > 0 and self.leg_width > 0 and 0 < self.inclination < np.pi / 2):
            value = (self.link_length, self.leg_width, self.inclination)
            limit, remedy = "L > 0, w > 0, 0 < psi < pi/2", "give metres and radians"
            raise InfeasibleDesign(
                "cannot be built", design="design (L, w, psi)", value=value, limit=limit, remedy=remedy
            )

    def __str__(self) -> str:
        psi = np.degrees(self.inclination)
        return f"L {self.link_length * 1e3:g} mm, w {self.leg_width * 1e3:g} mm, psi {psi:g} deg"

    def leg_offset(self, reading: Reading = "circumradius") -> float:
        """Return R [m]; see `leg_offset`."""
        return float(leg_offset(self.link_length, self.leg_width, self.inclination, reading))

    def robot(self, reading: Reading = "circumradius") -> Robot:
        """Return the nominal robot with this delta stage; the mid-plane reading is met by moving the base balls."""
        half = self.leg_width / 2
        inner = float(platform_radius(self.leg_width))
        outer = float(np.hypot(np.sqrt(inner**2 - half**2) + self.leg_offset(reading), half))
        return load_robot().replace(
            {
                "delta.link_length": self.link_length,
                "delta.leg_width": self.leg_width,
                "delta.platform_radius": inner,
                "delta.base_radius": outer,
            }
        )


CHOSEN = Design(0.064, 0.040, np.radians(27.0))
"""The design the paper selects."""
BEFORE = Design(0.086, 0.025, np.radians(21.0))
"""The design before the optimisation."""
