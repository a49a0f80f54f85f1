"""A stopped robot stays where it is, in stepped time: a held driver goes on, a hand stays or lets go."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from sher3_bringup.stepped_robot import SteppedRobot
from sher3_description import load_robot
from sher3_drivers.settings import default_settings
from sher3_kinematics import RobotKinematics
from sher3_runtime import Graph
from sher3_safety.rows.row import LIMIT
from sher3_safety.runs.operator_node import OperatorNode
from sher3_sim.plant_node import HOLD

pytestmark = pytest.mark.graph
ROBOT = load_robot()
TICKS = 1.0 / ROBOT.control_period
BRAKED = round(0.15 * TICKS)


class Bench:
    """A robot at its speed limit under a hand, and where its tip truly is after each tick."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.operator = graph.add(OperatorNode)
        self.robot = SteppedRobot(graph, robot=ROBOT, drives=default_settings(ROBOT.control_period))
        self.tip: list[np.ndarray] = []
        self.demand: list[float] = []
        self.run(60)
        self.operator.command("enable")
        self.run(60)
        self.operator.force, self.operator.pedal = LIMIT.force, LIMIT.pedal
        self.run(120)

    def run(self, ticks: int) -> None:
        plant = self.robot.plant
        for _ in range(ticks):
            self.graph.step()
            self.tip.append(plant.plant.true_tip[1])
            self.demand.append(float(np.abs(plant.reading.demand).max()))

    def moved(self, ticks: int) -> float:
        """Return how far the tip got from where it was before the last ticks, m."""
        way = np.array(self.tip[-ticks - 1 :])
        return float(np.linalg.norm(way - way[0], axis=1).max())


@pytest.fixture
def bench() -> Iterator[Bench]:
    with Graph(period=ROBOT.control_period, middleware=False) as graph:
        yield Bench(graph)


@pytest.mark.parametrize("held", [11, 14, 150])
def test_a_driver_that_goes_on_after_being_held_moves_nothing(bench, held):
    """What waited for it (commands, heartbeats) comes first, as after SIGCONT; up to 30 ms the drives are enabled."""
    assert bench.moved(10) == pytest.approx(10 / TICKS * LIMIT.speed, rel=0.05)
    bench.graph.pause(bench.robot.motor_driver)
    bench.run(held)
    bench.graph.resume(bench.robot.motor_driver)
    bench.run(BRAKED)
    assert bench.robot.motor_driver.driver.stop.reason is not None
    assert bench.moved(BRAKED + held) < LIMIT.budget
    bench.run(150)
    assert bench.moved(150) < 0.01e-6 and not any(bench.demand[-150:])


def test_a_stopped_tip_gives_way_by_the_drives_compliance_alone_when_the_hand_lets_go(bench):
    """The driver is dead. With the hand on it the tip rests to 10 nm; when the surgeon falls silent too, the plant lets
    the hand go after `HOLD`, and the tip moves by J diag(1/ki) J^T F: the drives hold like springs of stiffness ki.
    """
    bench.graph.pause(bench.robot.motor_driver)
    bench.run(2 * BRAKED)
    bench.run(150)
    assert bench.moved(150) < 0.01e-6
    bench.graph.pause(bench.operator)
    silent = round(HOLD * TICKS) - 1
    bench.run(silent)
    assert bench.moved(silent) < 0.01e-6
    bench.run(150)
    jacobian = RobotKinematics(ROBOT).jacobian(bench.robot.plant.plant.true_position)
    compliance = jacobian @ np.diag([1.0 / a.drive.ki for a in ROBOT.actuators]) @ jacobian.T
    given = np.linalg.norm((compliance @ [0.0, 0.0, LIMIT.force, 0.0, 0.0, 0.0])[:3])
    assert bench.moved(150) == pytest.approx(given, rel=0.01) and given > 10e-6
    assert not any(bench.demand[-150:])
