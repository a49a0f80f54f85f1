"""The constraints of the paper's optimisation as numbers, closed form and vectorised over designs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sher3_paper.search.design import Reading, leg_offset

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Workspace:
    """The cylinder the platform centre must cover: diameter and height [m]."""

    diameter: float = 0.055
    height: float = 0.060

    @property
    def radius(self) -> float:
        """Half the diameter [m]."""
        return self.diameter / 2

    def poses(self, count: int = 432) -> Floats:
        """Return positions (m, 2) [m] that stand for at least `count` positions of equal area over the disc.

        They lie on rings of equal area. The three legs make the mean over the disc equal to the mean over a sector of
        60 degrees, so only the sixth of the positions that lies in this sector is returned.
        """
        rings = max(1, round(np.sqrt(count / 6)))
        spokes = max(1, int(np.ceil(count / 6 / rings)))
        radius = self.radius * np.sqrt((np.arange(rings) + 0.5) / rings)
        angle = np.pi / 3 * (np.arange(spokes) + 0.5) / spokes
        return np.column_stack((np.outer(radius, np.cos(angle)).ravel(), np.outer(radius, np.sin(angle)).ravel()))


@dataclass(frozen=True)
class Quantities:
    """What the constraints limit, each (n,); lengths in m, angles in rad.

    Attributes:
        reaches: Whether every leg reaches across the disc, R + radius < L.
        clearance: r_b - r_p, both as printed (L sin(psi)).
        midplane_clearance: R, the same distance between the mid-planes of the legs.
        stroke: Range of one slider over the cylinder.
        swing: Largest angle of a leg from its direction at the centre.
        cone: Half angle of the narrowest cone that holds all directions of a leg.
    """

    reaches: Flags
    clearance: Floats
    midplane_clearance: Floats
    stroke: Floats
    swing: Floats
    cone: Floats


def quantities(
    link_length: ArrayLike,
    leg_width: ArrayLike,
    inclination: ArrayLike,
    reading: Reading = "circumradius",
    workspace: Workspace | None = None,
) -> Quantities:
    """Return the constrained quantities of designs given as arrays (n,); NaN where a leg does not reach.

    The extreme leg directions lie in the leg's own plane, at the near and far side of the disc.
    """
    space = Workspace() if workspace is None else workspace
    length, psi = np.asarray(link_length, dtype=float), np.asarray(inclination, dtype=float)
    offset = leg_offset(length, leg_width, psi, reading)
    near, far = offset - space.radius, offset + space.radius
    reaches = far < length
    with np.errstate(invalid="ignore"):
        tallest = np.sqrt(length**2 - np.maximum(near, 0.0) ** 2)
        stroke = space.height + tallest - np.sqrt(length**2 - far**2)
        centre, low, high = (np.arcsin(distance / length) for distance in (offset, near, far))
    swing = np.maximum(high - centre, centre - low)
    return Quantities(reaches, length * np.sin(psi), offset, stroke, swing, (high - low) / 2)


@dataclass(frozen=True)
class Constraints:
    """Limits of the quantities; None leaves one out. The defaults are the paper's as stated, read literally.

    Attributes:
        clearance: least r_b - r_p [m].
        midplane_clearance: least distance of the leg mid-planes [m].
        stroke: largest slider range [m].
        swing: largest swing [rad] about the direction at the centre.
        cone: largest half angle [rad] of the narrowest cone.
    """

    clearance: float | None = 0.030
    midplane_clearance: float | None = None
    stroke: float | None = 0.090
    swing: float | None = np.radians(30.0)
    cone: float | None = None

    def each(self, values: Quantities) -> dict[str, Flags]:
        """Return, by name, which designs meet each constraint; reach is always one of them."""
        met = {"reach": values.reaches}
        with np.errstate(invalid="ignore"):
            if self.clearance is not None:
                met["clearance"] = values.clearance > self.clearance
            if self.midplane_clearance is not None:
                met["midplane_clearance"] = values.midplane_clearance > self.midplane_clearance
            if self.stroke is not None:
                met["stroke"] = values.stroke < self.stroke
            if self.swing is not None:
                met["swing"] = values.swing < self.swing
            if self.cone is not None:
                met["cone"] = values.cone < self.cone
        return met

    def met(self, values: Quantities) -> Flags:
        """Return which designs meet every constraint (n,)."""
        return np.logical_and.reduce(list(self.each(values).values()))


AS_STATED = Constraints()
RELAXED = Constraints(clearance=None, stroke=None, swing=None, cone=np.radians(30.0))
"""Without clearance and stroke, and with the swing about the best axis; the chosen design still does not meet these."""
REACH_ONLY = Constraints(clearance=None, stroke=None, swing=None)
