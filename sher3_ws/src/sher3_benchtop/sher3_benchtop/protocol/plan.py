"""The paper's five tests as timelines (section V-A), checked before anything moves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sher3_description import Robot
from sher3_kinematics import RobotKinematics
from sher3_kinematics.tip_deflection import TipDeflection
from sher3_paper.tables import deflection_table

from sher3_benchtop.fixture import GRASP_FROM_PLATFORM, grasp_from_tip, home, wrench_at_tip
from sher3_benchtop.protocol.timeline import Builder, Timeline

Floats = NDArray[np.float64]
PLANES = {"xz": (0, 2), "yz": (1, 2)}
"""Planes of the grids and of the cameras: the axes of {b} they show."""
DOWN = np.array([0.0, 0.0, -1.0])
"""Direction of the needle during the grids."""
STEP = np.radians(0.02)
"""Commanded rotation [rad] of the roll and tilt test."""


@dataclass(frozen=True)
class Plan:
    """The free choices of the tests.

    Attributes:
        visits: of each point in the repeatability tests (paper: 5).
        cycles: of each rotation and each push (paper: 3 pushes; rotations not stated).
        centre: of the grids, seen from the tip at home (3,) [m].
        pull, push: ends of the force at the grasping point [N] (paper: about -6 and 8).
        speed: largest speed of the tip between two places [m/s].
        dwell: rest before a picture [s], see `Builder`.
        seed: of the random order.
    """

    visits: int = 5
    cycles: int = 3
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
    pull: float = -6.0
    push: float = 8.0
    speed: float = 0.008
    dwell: float = 0.4
    seed: int = 0

    def seconds(self, distance: float) -> float:
        """Return the time of a minimum-jerk motion, whose peak speed is 1.875 times its mean."""
        return max(0.1, 1.875 * distance / self.speed)


FAST = Plan(visits=2, cycles=1)
"""A quarter of the time, enough to see that everything works."""


@dataclass(frozen=True)
class Grid:
    """A square grid.

    Attributes:
        name: of the test.
        spacing: of neighbouring points [m].
        count: points along a side.
    """

    name: str
    spacing: float
    count: int

    @property
    def points(self) -> Floats:
        """Points (count^2, 2) [m] about the centre, horizontal and vertical; row by row, every other row backwards."""
        line = self.spacing * (np.arange(self.count, dtype=np.float64) - (self.count - 1) / 2)
        rows = [np.column_stack((line[:: (-1) ** k], np.full(self.count, v))) for k, v in enumerate(line)]
        return np.vstack(rows)


ACCURACY = Grid("grid_10mm", 5e-3, 3)
REPEATABILITY = Grid("grid_2mm", 1e-3, 3)
RESOLUTION = Grid("grid_10um", 10e-6, 2)


def random_order(points: int, visits: int, rng: np.random.Generator) -> list[int]:
    """Return each of `points` numbers `visits` times, shuffled, none twice in a row: each is reached by a motion."""
    while True:
        order = rng.permutation(np.repeat(np.arange(points), visits))
        for k in range(1, len(order)):
            different = np.flatnonzero(order[k:] != order[k - 1])
            if order[k] == order[k - 1] and len(different):
                swap = k + int(different[0])
                order[k], order[swap] = order[swap], order[k]
        if (np.diff(order) != 0).all():
            return [int(k) for k in order]


def grid_test(robot: Robot, plan: Plan, grid: Grid, visits: int = 1) -> Timeline:
    """Return the visits to a grid in both planes: in the order of the grid once, else in random order."""
    start, rng = home(robot), np.random.default_rng(plan.seed)
    centre = start + np.array(plan.centre)
    run = Builder(start, robot.control_period, plan.dwell)
    for plane, axes in PLANES.items():
        points = grid.points
        order = list(range(len(points))) if visits == 1 else random_order(len(points), visits, rng)
        for k in order:
            goal = centre.copy()
            goal[list(axes)] += points[k]
            run.move(goal, plan.seconds(float(np.linalg.norm(goal - run.place))))
            run.picture(plane, k)
    return run.build(grid.name, "servo_cp")


def rotation_test(robot: Robot, plan: Plan) -> Timeline:
    """Return roll, then tilt, to and fro by `STEP`: each actuator alone, the others hold."""
    run = Builder(np.zeros(5), robot.control_period, plan.dwell)
    slider = RobotKinematics(robot).tilt_linkage.slider(STEP)
    for axis, row, stroke in (("roll", 3, STEP), ("tilt", 4, slider)):
        for _ in range(2 * plan.cycles + 4):
            for target in (1, 0):
                goal = np.zeros(5)
                goal[row] = target * stroke
                run.move(goal, 0.1)
                run.picture(axis, target)
    return run.build("rotation", "servo_jp")


def push_places(robot: Robot) -> Floats:
    """Return tip positions (5, 3) [m] that put P at the places of the deflection table; its height is not printed."""
    tip_from_platform = GRASP_FROM_PLATFORM - grasp_from_tip(robot)
    height = (home(robot) - tip_from_platform)[2]
    places = deflection_table().positions
    return np.column_stack((places, np.full(len(places), height))) + tip_from_platform


def deflection_test(robot: Robot, plan: Plan) -> Timeline:
    """Return pushes and pulls along x, y and z at the five places, held until the robot is at rest."""
    run = Builder(home(robot), robot.control_period, plan.dwell)
    for number, place in enumerate(push_places(robot)):
        run.move(place, plan.seconds(float(np.linalg.norm(place - run.place))))
        for row, axis in enumerate("xyz"):
            run.picture(f"{axis}{number}", number)
            for force in (plan.push, plan.pull) * plan.cycles:
                run.push(force * np.eye(3)[row])
                run.picture(f"{axis}{number}", number, force)
            run.push(np.zeros(3))
    return run.build("deflection", "servo_cp")


TESTS: dict[str, Callable[[Robot, Plan], Timeline]] = {
    "grid_10mm": lambda robot, plan: grid_test(robot, plan, ACCURACY),
    "grid_2mm": lambda robot, plan: grid_test(robot, plan, REPEATABILITY, plan.visits),
    "grid_10um": lambda robot, plan: grid_test(robot, plan, RESOLUTION, plan.visits),
    "rotation": rotation_test,
    "deflection": deflection_test,
}
"""The tests in the order of the paper."""


def planned(name: str, robot: Robot, plan: Plan) -> Timeline:
    """Return a test that the robot can do.

    Args:
        name: a key of `TESTS`.
        robot: on the bench, see `bench_robot`.
        plan: choices.

    Raises:
        Unreachable, OutsideLimits: a place is out of reach; names it and by how much.
        LoadBeyondRange: a force is more than the sensor can measure.
    """
    timeline = TESTS[name](robot, plan)
    kinematics, deflection = RobotKinematics(robot), TipDeflection(robot)
    ends = [picture.tick for picture in timeline.pictures]
    wrenches = wrench_at_tip(robot, timeline.forces[ends])
    for place, wrench in zip(timeline.commands[ends], wrenches, strict=True):
        if timeline.mode == "servo_cp":
            q = kinematics.inverse(place, DOWN)
        else:
            kinematics.require_within_limits(place)
            q = place
        deflection(q, wrench)
    return timeline
