"""A speed regime reaches the drives: their own speed limit follows `command/regime`, in the whole graph."""

import pytest
from sher3_bringup.stepped_robot import SteppedRobot
from sher3_common.samples import TextSample
from sher3_control.settings import ControlSettings
from sher3_description import load_robot
from sher3_drivers.canopen import objects as od
from sher3_runtime import Graph

pytestmark = pytest.mark.graph
NEAR, FREE = [60, 60, 60, 29, 27], [366, 366, 366, 287, 270]


def test_the_drives_get_the_limits_of_the_regime_before_it_begins_and_after_it_ended():
    robot = load_robot()
    control = ControlSettings.from_robot(robot, {"motion": {"regime": "near_tissue"}})
    with Graph(middleware=False) as graph:
        stepped = SteppedRobot(graph, seed=1, robot=robot, control=control)
        probe = graph.probe("motion/settings", sends=("command/regime",))
        motion, drives = stepped.kinematics.motion, stepped.plant.drives.drives.values()
        of_drives = lambda: [drive.node.values[od.MAX_MOTOR_SPEED] for drive in drives]  # noqa: E731
        graph.step(50)
        assert of_drives() == NEAR and motion.regime.value == "near_tissue"
        probe.send("command/regime", TextSample("free"))
        for _ in range(40):
            graph.step()
            assert motion.regime.value == "near_tissue" or of_drives() == FREE
        assert motion.regime.value == "free"
        probe.send("command/regime", TextSample("near_tissue"))
        graph.step(2)
        assert motion.regime.value == "near_tissue"
        graph.step(80)
        assert of_drives() == NEAR and stepped.motor_driver.driver.stop.first is None
