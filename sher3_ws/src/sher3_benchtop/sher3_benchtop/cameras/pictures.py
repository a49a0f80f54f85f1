"""What was in front of the cameras: true tip and grasping point at every picture of a recorded test."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_description import Robot
from sher3_paper.errors import BadData

from sher3_benchtop.fixture import grasp_from_tip
from sher3_benchtop.protocol.plan import PLANES
from sher3_benchtop.protocol.timeline import Timeline

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Shots:
    """The pictures of one group, all arrays with one row per picture.

    Attributes:
        target: commanded places in the group's numbering (n,).
        force: at the grasping point [N] (n,).
        tip, grasp: true positions (n, 3) [m] in {b}.
    """

    target: Ints
    force: Floats
    tip: Floats
    grasp: Floats

    def plane(self, name: str) -> Floats:
        """Return the tip (n, 2) [m] in a plane, seen from the mean of all pictures, where the camera points."""
        places = self.tip[:, list(PLANES[name])]
        return places - places.mean(axis=0)


def taken(timeline: Timeline, tracker: Any, first: int, period: float, robot: Robot) -> dict[str, Shots]:
    """Return the pictures of a recorded test by group.

    Args:
        timeline: that was commanded.
        tracker: stream of the true tip pose with `stamp`, `position` and `orientation`.
        first: stamp of the first tick of the timeline [ns].
        period: of a tick [s].
        robot: on the bench.

    Raises:
        BadData: the recording ends before a picture.
    """
    ticks = np.array([picture.tick for picture in timeline.pictures])
    stamps = first + np.round(ticks * period * 1e9).astype(np.int64)
    rows = np.searchsorted(tracker.stamp, stamps, side="right") - 1
    late = stamps - tracker.stamp[np.maximum(rows, 0)]
    if (rows < 0).any() or late.max() > 20_000_000:
        worst = float(late.max()) * 1e-9
        raise BadData(
            "no tracker sample at a picture, age [s]", value=worst, limit=0.02, remedy="record the whole test"
        )
    position = tracker.position[rows]
    grasp = position + rotated(tracker.orientation[rows], grasp_from_tip(robot))
    groups = np.array([picture.group for picture in timeline.pictures])
    target = np.array([picture.target for picture in timeline.pictures])
    force = np.array([picture.force for picture in timeline.pictures])
    return {
        str(name): Shots(target[groups == name], force[groups == name], position[groups == name], grasp[groups == name])
        for name in dict.fromkeys(groups.tolist())
    }


def rotated(quaternions: Floats, vector: Floats) -> Floats:
    """Return a vector (3,) rotated by unit quaternions (n, 4), x y z w."""
    axis, w = quaternions[:, :3], quaternions[:, 3:]
    twice = 2.0 * np.cross(axis, vector)
    return vector + w * twice + np.cross(axis, twice)
