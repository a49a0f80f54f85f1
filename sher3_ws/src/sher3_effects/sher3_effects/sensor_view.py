"""What effects may ask of a force sensor on its own: readings in known orientations or under known weights."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from sher3_diagnosis.channel import Array


class SensorView(Protocol):
    """Readings of one sensor, g of them."""

    mass: float
    """Mass that hangs on the sensor as stated or identified, kg."""
    gravity: Array
    """(g, 3) acceleration of gravity in the sensor's stated frame, m/s^2."""
    elapsed: Array
    """(g,) share of the test that had passed, 0 to 1."""
    warmth: Array
    """(g,) temperature above the first reading's, K; zero where it was not recorded."""

    def wrench(self, frame: int) -> Array:
        """Return (g, 6) nominal wrench as another frame of the list would give it, N and N m; 0 is the stated one."""

    frames: int
    """Number of frames in the list."""

    def turn(self, frame: int) -> Array:
        """Return (3,) rotation vector by which forces in a frame of the list fit the readings best, rad."""

    def frame_in_words(self, frame: int, further: Sequence[float]) -> str:
        """Return how readings are expressed in a frame turned further by a rotation vector (3,); nothing as stated."""

    def load_in_words(self, mass: float, moment: Sequence[float]) -> str:
        """Return the load with a further mass, kg, and first moment (3,), kg m; nothing where there is none."""
