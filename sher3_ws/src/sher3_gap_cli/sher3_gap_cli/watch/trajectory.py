"""Points of a trajectory as set-points, joined as joint_trajectory_controller of ros2_controllers joins them.

Between two points positions alone are joined by lines, positions with velocities by cubic polynomials, and those with
accelerations as well by quintic ones (trajectory representation, documentation of ros2_controllers).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BPoly

Array = NDArray[np.float64]


class Point(NamedTuple):
    """Where the joints are to be: seconds after the start, positions (k,), velocities and accelerations, or empty."""

    after: float
    position: Sequence[float]
    velocity: Sequence[float] = ()
    acceleration: Sequence[float] = ()

    @property
    def order(self) -> int:
        """How many derivatives are stated, position included: 1 to 3."""
        known = (self.velocity, self.acceleration)
        return 1 + next((i for i, x in enumerate(known) if len(x) != len(self.position)), len(known))


def set_points(points: Sequence[Point], before: Sequence[float], period: float) -> tuple[Array, Array]:
    """Return seconds after the start (n,), and set-points (n, k).

    Args:
        points: of the trajectory, in order of time.
        before: set-point at the start, (k,); the joints are taken to rest there.
        period: of the set-points, s.
    """
    if points[0].after > 0.0:
        still = [0.0] * len(before)
        points = [Point(0.0, before, still, still), *points]
    after = np.append(np.arange(0.0, points[-1].after, period), points[-1].after)
    if len(points) == 1:
        return after, np.array([points[0].position], dtype=float)
    order = min(p.order for p in points)
    states = np.array([(p.position, p.velocity, p.acceleration)[:order] for p in points], dtype=float)
    smooth = BPoly.from_derivatives([p.after for p in points], states)
    return after, np.asarray(smooth(after))
