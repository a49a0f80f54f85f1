"""A second recording as a ghost beside the first, its distance exaggerated by a stated factor."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_bags import Run
from sher3_description import Robot, load_robot
from sher3_kinematics import RobotKinematics

from sher3_view.errors import ViewError
from sher3_view.film import Film, film_of
from sher3_view.scene import RobotState, Scene


class Ghost(NamedTuple):
    """The second robot, frame by frame of the first.

    Attributes:
        name: of the recording.
        points: (n, k, 3) [m] in {b}, as `Film.points`.
        exaggeration: by which the distance of the actuators from those of the first robot was multiplied.
    """

    name: str
    points: NDArray[np.float64]
    exaggeration: float


def ghost_of(film: Film, run: Run, exaggeration: float = 1.0, robot: Robot | None = None) -> Ghost:
    """Return the ghost of a run beside a film; both begin at their first frames.

    The actuators are drawn at q + factor (q_ghost - q), held within their travel, so that legs keep their length.

    Raises:
        ViewError: the run has nothing to show, or the factor is below 1.
    """
    if exaggeration < 1.0:
        raise ViewError("the exaggeration makes the difference smaller", value=exaggeration, limit="at least 1")
    other = film_of(run, robot)
    if robot is None:
        robot = Robot.from_yaml(run.robot_yaml) if run.robot_yaml else load_robot()
    kinematics = RobotKinematics(robot)
    rows = np.searchsorted(other.seconds - other.seconds[0], film.seconds - film.seconds[0])
    theirs = other.position[np.clip(rows, 0, len(other.seconds) - 1)]
    q = np.clip(film.position + exaggeration * (theirs - film.position), kinematics.lower, kinematics.upper)
    scene = Scene(kinematics)
    shots = [scene.moving(RobotState(row)) for row in q]
    points = np.array([np.concatenate([part.points for part in shot]) for shot in shots])
    return Ghost(other.name, points, exaggeration)
