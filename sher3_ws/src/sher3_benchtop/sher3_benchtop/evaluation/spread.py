"""The accuracy table over many robots as built, without the graph: each robot at rest at the points of the grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sher3_description import Robot
from sher3_kinematics import RobotKinematics
from sher3_sim import Plant, PlantEffect

from sher3_benchtop.as_built import as_built
from sher3_benchtop.cameras.pictures import Shots
from sher3_benchtop.evaluation.evaluate import evaluate
from sher3_benchtop.fixture import home
from sher3_benchtop.protocol.plan import ACCURACY, DOWN, PLANES

Floats = NDArray[np.float64]


def at_rest(robot: Robot, effects: list[PlantEffect]) -> dict[str, Shots]:
    """Return the accuracy grid of a robot on the bench that rests where its encoders read the commanded places."""
    kinematics, plant, start = RobotKinematics(robot), Plant(robot, effects), home(robot)
    shots = {}
    for plane, axes in PLANES.items():
        tips = []
        for point in ACCURACY.points:
            goal = start.copy()
            goal[list(axes)] += point
            tracker = plant.reset(kinematics.inverse(goal, DOWN)).tracker
            assert tracker is not None
            tips.append(tracker[:3])
        count = len(tips)
        shots[plane] = Shots(np.arange(count), np.zeros(count), np.array(tips), np.array(tips))
    return shots


def accuracy_spread(robot: Robot, robots: int) -> dict[str, Floats]:
    """Return the 5th, 50th and 95th percentile (3,) [um] of each entry of the accuracy table over robots as built."""
    draws = [evaluate({"grid_10mm": at_rest(robot, as_built(seed))}, "tip") for seed in range(robots)]
    return {name: np.percentile([draw[name] for draw in draws], (5, 50, 95)) for name in draws[0]}
