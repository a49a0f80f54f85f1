"""What effects may ask of a table without a clock: targets and readings (ISO 230-2), and circles (ISO 230-4)."""

from __future__ import annotations

from typing import Protocol

from sher3_diagnosis.channel import Array


class TableView(Protocol):
    """Rows of a positioning test of one axis."""

    @property
    def target(self) -> Array:
        """(g,) targets, counted from the middle of the travel, m or rad."""

    @property
    def direction(self) -> Array:
        """(g,) +1 where the target was reached with growing position, -1 where with falling."""

    @property
    def warmth(self) -> Array:
        """(g,) temperature above the reference, K; zero where it was not recorded."""

    @property
    def elapsed(self) -> Array:
        """(g,) share of the test that had passed, 0 to 1."""

    @property
    def nodes(self) -> Array:
        """(k,) distinct targets of the whole test, counted from the middle of the travel, m or rad."""

    @property
    def lead(self) -> float | None:
        """Travel per motor revolution, m or rad, where it is known."""


class CircleView(Protocol):
    """Points of a circle that two axes moved on."""

    @property
    def angle(self) -> Array:
        """(g,) angle of each point about the centre, rad."""

    @property
    def radius(self) -> float:
        """Radius of the circle, m."""

    def across(self, site: str) -> Array:
        """Return (g,) change of the radius per shift along an axis: cosine or sine of the angle."""

    def moving(self, site: str) -> Array:
        """Return (g,) sign of an axis' motion."""
