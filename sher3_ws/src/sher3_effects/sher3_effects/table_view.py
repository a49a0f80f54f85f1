"""Readings of a machine at rest as the engine and the effects see them: rows are no course in time.

A load cell under known forces, targets and readings of an axis (ISO 230-2), and points of a circle (ISO 230-4).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.evidence import Motion


@dataclass(frozen=True, eq=False)
class Still:
    """Rows without a clock; a kind of table adds what its effects ask for.

    Class attributes:
        excitation: name of what was recorded.
        rate: None, rows are no course in time.
        by_temperature: whether a regime may be named after the temperature.

    Attributes:
        warmth: (g,) temperature above the reference, K; zero where it was not recorded.
    """

    excitation = "readings"
    rate = None
    by_temperature = True
    warmth: Array

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.warmth)

    @property
    def temperature_known(self) -> bool:
        """Whether the temperature changed."""
        return self.by_temperature and bool(self.warmth.any())

    @property
    def loaded(self) -> Mask:
        """(g,) False: nothing acts beside what is known."""
        return np.zeros(self.rows, dtype=bool)

    @property
    def speed_share(self) -> Array:
        """(g,) zero: the machine is at rest when it is measured."""
        return np.zeros(self.rows)

    @property
    def elapsed(self) -> Array:
        """(g,) share of the test that had passed."""
        return np.linspace(0.0, 1.0, self.rows)

    def motion(self, actuator: str) -> Motion | None:
        """Return None: nothing moves."""
        return None

    def inputs(self, actuator: str) -> Array:
        """Return (g, k) quantities a static law could depend on; each kind says them, else NotImplementedError."""
        raise NotImplementedError


@dataclass(frozen=True, eq=False)
class CellView(Still):
    """All readings of a cell.

    Attributes:
        applied: (g,) known force, N or N m.
        unloading: (g,) 1 where it was reached from a larger one, else 0.
    """

    excitation = "forces"
    applied: Array
    unloading: Array

    @cached_property
    def share(self) -> Array:
        """(g,) place of the force between the least and the largest force."""
        return (self.applied - self.applied.min()) / float(np.ptp(self.applied))

    @cached_property
    def no_load(self) -> float:
        """Place of no force in the range, 0 to 1; of forces of one sense its end nearest to none."""
        return float(np.clip(-self.applied.min() / np.ptp(self.applied), 0.0, 1.0))

    def inputs(self, actuator: str) -> Array:
        """Return force, direction, warmth and order (g, 4)."""
        return np.column_stack([self.applied, self.unloading, self.warmth, self.elapsed])


@dataclass(frozen=True, eq=False)
class TableView(Still):
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
class CircleView(Still):
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
