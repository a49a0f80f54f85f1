"""Rows of a positioning test and points of a circle as effects see them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_static.view import Still


@dataclass(frozen=True, eq=False)
class RowsView(Still):
    """All rows of one axis.

    Attributes:
        target: (g,) from the middle of the travel, m or rad.
        direction: (g,) side of the approach, +1 or -1.
        lead: travel per motor revolution, m or rad.
    """

    excitation, by_temperature = "cycle", False
    target: Array
    direction: Array
    lead: float | None

    @cached_property
    def nodes(self) -> Array:
        """(k,) distinct targets."""
        return np.unique(self.target)

    def inputs(self, actuator: str) -> Array:
        """Return target, direction, warmth and order (g, 4)."""
        return np.column_stack([self.target, self.direction, self.warmth, self.elapsed])


@dataclass(frozen=True, eq=False)
class RingView(Still):
    """All points of one circle.

    Attributes:
        angle: (g,) about the centre, rad.
        turning: (g,) +1 counter-clockwise, -1 clockwise.
        radius: nominal, m.
    """

    excitation = "circle"
    angle: Array
    turning: Array
    radius: float

    def across(self, site: str) -> Array:
        """Return (g,) change of the radius per shift along the axis `PLANE.x` or `PLANE.y`."""
        return np.cos(self.angle) if site.endswith(".x") else np.sin(self.angle)

    def moving(self, site: str) -> Array:
        """Return (g,) sign of an axis' motion."""
        return self.turning * np.sign(-np.sin(self.angle) if site.endswith(".x") else np.cos(self.angle))

    def inputs(self, actuator: str) -> Array:
        """Return the point on the unit circle and its direction (g, 3)."""
        return np.column_stack([np.cos(self.angle), np.sin(self.angle), self.turning])
