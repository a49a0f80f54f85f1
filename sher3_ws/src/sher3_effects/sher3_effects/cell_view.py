"""What effects may ask of a load cell: readings under known forces, one after the other."""

from __future__ import annotations

from typing import Protocol

from sher3_diagnosis.channel import Array


class CellView(Protocol):
    """Readings of one load cell, g of them."""

    @property
    def applied(self) -> Array:
        """(g,) known force, N or N m."""

    @property
    def share(self) -> Array:
        """(g,) place of the force between the least and the largest one, 0 to 1."""

    @property
    def unloading(self) -> Array:
        """(g,) 1 where the force was reached from a larger one, 0 elsewhere."""

    @property
    def elapsed(self) -> Array:
        """(g,) share of the test that had passed, 0 to 1."""

    @property
    def warmth(self) -> Array:
        """(g,) temperature above the first reading's, K; zero where it was not recorded."""
