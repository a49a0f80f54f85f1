"""The frames that readings may be in: quarter turns of the sensor, orientation the other way round, the reaction."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import permutations, product
from typing import NamedTuple

import numpy as np
from scipy.constants import g
from scipy.spatial.transform import Rotation
from sher3_diagnosis.channel import Array

DOWN = np.array([0.0, 0.0, -g])
"""Acceleration of gravity in a frame whose z points up, m/s^2."""
HALF_TURN = 179.0
"""Angle, degrees, from which a turn is half a turn."""


class Frame(NamedTuple):
    """How readings may be expressed.

    Attributes:
        turn: (3, 3) quarter turns from the stated frame to that of the readings.
        inverted: whether the stated orientation is that of the upright frame in the sensor.
        sign: -1 where the reaction is read.
    """

    turn: Array
    inverted: bool
    sign: float

    def gravity(self, orientation: Array) -> Array:
        """Return the acceleration of gravity (n, 3) as the readings have it."""
        into = orientation if self.inverted else np.swapaxes(orientation, 1, 2)
        return self.sign * (into @ DOWN) @ self.turn.T

    def __str__(self) -> str:
        parts = []
        turn = Rotation.from_matrix(self.turn).as_rotvec(degrees=True)
        size = float(np.linalg.norm(turn))
        if size > HALF_TURN:  # two axes: the one that points along its largest component is given
            turn = turn * np.sign(turn[np.argmax(np.abs(turn))])
        if size > 1.0:
            axis = ", ".join(f"{round(x, 2) + 0.0:g}" for x in turn / size)
            parts.append(f"its axes are turned by {size:.0f} degrees about ({axis})")
        if self.inverted:
            parts.append("its orientation is stated the other way round")
        if self.sign < 0.0:
            parts.append("it reads the reaction, with the opposite sign")
        return ", and ".join(parts) or "as stated"


def turned(frame: Frame, further: Sequence[float]) -> Frame:
    """Return a frame whose readings are turned further by a rotation vector (3,), rad."""
    return frame._replace(turn=Rotation.from_rotvec(further).as_matrix() @ frame.turn)


@lru_cache(maxsize=1)
def frames() -> tuple[Frame, ...]:
    """Return all frames, the stated one first and then those with the fewest differences."""
    turns = []
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            matrix = np.zeros((3, 3))
            matrix[range(3), order] = signs
            if np.linalg.det(matrix) > 0.0:
                turns.append(matrix)
    turns.sort(key=lambda r: float(np.linalg.norm(Rotation.from_matrix(r).as_rotvec())))
    found = [Frame(r, inverted, sign) for r in turns for inverted in (False, True) for sign in (1.0, -1.0)]
    return tuple(sorted(found, key=lambda f: bool(np.trace(f.turn) < 3.0) + f.inverted + (f.sign < 0.0)))
