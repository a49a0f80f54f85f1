"""Other robots as ghosts beside the first, their distance exaggerated by a stated factor: recordings, simulators."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_bags import Run
from sher3_description import Robot, load_robot
from sher3_kinematics import RobotKinematics
from sher3_sim.effect import PlantEffect

from sher3_view.errors import ViewError
from sher3_view.film import Film, at_times, joints_of
from sher3_view.scene import RobotState, Scene


class Ghost(NamedTuple):
    """Another robot, frame by frame of the first.

    Attributes:
        name: of the recording or the simulator.
        points: (n, k, 3) [m] in {b}, as `Film.points`.
        exaggeration: by which the distance of the actuators from those of the first robot was multiplied.
        distance: (n,) [m] of its tip from that of the first robot, as it is.
    """

    name: str
    points: NDArray[np.float64]
    exaggeration: float
    distance: NDArray[np.float64]


def ghost_of(film: Film, run: Run, exaggeration: float = 1.0, robot: Robot | None = None, name: str = "") -> Ghost:
    """Return the ghost of a run beside a film; both begin at their first samples, and the later one ends at rest.

    The actuators are drawn at q + factor (q_ghost - q), held within their travel, so that legs keep their length.

    Raises:
        ViewError: the run has nothing to show, or the factor is below 1.
    """
    if exaggeration < 1.0:
        raise ViewError("the exaggeration makes the difference smaller", value=exaggeration, limit="at least 1")
    stamps, position = joints_of(run)
    if robot is None:
        robot = Robot.from_yaml(run.robot_yaml) if run.robot_yaml else load_robot()
    kinematics = RobotKinematics(robot)
    # Between two samples, not at the nearer one: half a period of motion would be drawn as a gap.
    theirs = at_times(stamps, position, stamps[0] + np.round((film.seconds - film.seconds[0]) * 1e9).astype(np.int64))
    q = np.clip(film.position + exaggeration * (theirs - film.position), kinematics.lower, kinematics.upper)
    scene = Scene(kinematics)
    shots = [scene.moving(RobotState(row)) for row in q]
    points = np.array([np.concatenate([part.points for part in shot]) for shot in shots])
    distance = np.linalg.norm(kinematics.transform_tip_to_base_batch(theirs)[1] - film.tip, axis=1)
    return Ghost(name or (run.path.name if run.path else "run"), points, exaggeration, distance)


def simulated(run: Run, effects: Iterable[PlantEffect] = (), robot: Robot | None = None) -> Run:
    """Return what the simulator with these effects does when set-points and wrench of a run drive it.

    A run without set-points, of the cooperative mode, drives it with its commands: differences then add up.

    Raises:
        MissingTopicError: the run lacks `measured_js`, `force/measured_cf`, or both `setpoint_js` and `servo_jv`.
    """
    from sher3_sim.replay import resimulate

    if robot is None:
        robot = Robot.from_yaml(run.robot_yaml) if run.robot_yaml else load_robot()
    open_loop = "setpoint_js" not in run or not len(run["setpoint_js"])
    return resimulate(run, robot, effects, open_loop=open_loop)
