"""Rows and circles as effects and engine see them; none is a course in time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.evidence import Motion


@dataclass(frozen=True, eq=False)
class Still:
    """What the engine reads of a table without a clock; `rows` is the number of rows."""

    rows: int

    @property
    def excitation(self) -> str:
        """Name of what was recorded."""
        return "cycle"

    @property
    def rate(self) -> None:
        """None: rows are no course in time."""

    @property
    def loaded(self) -> Mask:
        """(g,) False: no load was recorded."""
        return np.zeros(self.rows, dtype=bool)

    @property
    def speed_share(self) -> Array:
        """(g,) zero: the axis is at rest when it is measured."""
        return np.zeros(self.rows)

    @property
    def temperature_known(self) -> bool:
        """False: no regime is named after it."""
        return False

    @property
    def warmth(self) -> Array:
        """(g,) zero."""
        return np.zeros(self.rows)

    def motion(self, actuator: str) -> Motion | None:
        """Return None: nothing moves."""
        return None


@dataclass(frozen=True, eq=False)
class RowsView(Still):
    """All rows of one axis.

    Attributes:
        target: (g,) from the middle of the travel, m or rad.
        direction: (g,) side of the approach, +1 or -1.
        temperature: (g,) above the reference, K.
        lead: travel per motor revolution, m or rad.
    """

    target: Array
    direction: Array
    temperature: Array
    lead: float | None

    @property
    def warmth(self) -> Array:
        """(g,) temperature above the reference, K."""
        return self.temperature

    @cached_property
    def elapsed(self) -> Array:
        """(g,) share of the test that had passed."""
        return np.linspace(0.0, 1.0, self.rows)

    @cached_property
    def nodes(self) -> Array:
        """(k,) distinct targets."""
        return np.unique(self.target)

    def inputs(self, actuator: str) -> Array:
        """Return target, direction, warmth and order (g, 4)."""
        return np.column_stack([self.target, self.direction, self.temperature, self.elapsed])


@dataclass(frozen=True, eq=False)
class RingView(Still):
    """All points of one circle.

    Attributes:
        angle: (g,) about the centre, rad.
        turning: (g,) +1 counter-clockwise, -1 clockwise.
        radius: nominal, m.
    """

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
