"""The bench-top evaluation on the graph: all nodes, CAN frames and plant in stepped time; each test leaves a bag."""

from __future__ import annotations

import numpy as np
import pytest
from sher3_bags.live import bag_folder
from sher3_bringup.benchtop import run_timeline
from sher3_bringup.errors import BenchtopStopped
from sher3_control.settings import ControlSettings
from sher3_description import load_robot
from sher3_kinematics import RobotKinematics
from sher3_paper.benchtop.as_built import as_built
from sher3_paper.benchtop.fixture import bench_robot, home
from sher3_paper.benchtop.protocol import DOWN, Grid, Plan, grid_test
from sher3_paper.benchtop.timeline import Builder
from sher3_sim import Plant

pytestmark = pytest.mark.graph
ROBOT = bench_robot(load_robot())
FOLDER = bag_folder("benchtop")


def test_the_running_robot_goes_where_a_resting_one_would_be():
    """Four points 1 mm apart, robot as built: what the chain of nodes reaches is the plant at rest at the IK's goal."""
    effects, grid = as_built(), Grid("test_grid", 1e-3, 2)
    timeline = grid_test(ROBOT, Plan(), grid)
    shots = run_timeline(timeline, ROBOT, effects, FOLDER)
    plant, kinematics = Plant(ROBOT, effects), RobotKinematics(ROBOT)
    rest = {}
    for picture in timeline.pictures:
        goal = kinematics.inverse(timeline.commands[picture.tick], DOWN)
        rest.setdefault(picture.group, []).append(plant.reset(goal).tracker[:3])
    for plane, tips in rest.items():
        assert shots[plane].tip == pytest.approx(np.array(tips), abs=1.5e-6), plane
    assert (FOLDER / "test_grid").is_dir()


@pytest.mark.parametrize("compensate", [False, True])
def test_compensation_leaves_little_of_the_deflection(compensate):
    """4 N along y at the grasping point move the tip of the running robot by a millimetre, or hardly at all."""
    run = Builder(home(ROBOT), ROBOT.control_period, dwell=1.0)
    run.picture("y0", 0)
    run.push([0.0, 4.0, 0.0])
    run.picture("y0", 0, 4.0)
    control = ControlSettings.from_robot(ROBOT, {"motion": {"deflection_compensation": compensate, "regime": "bench"}})
    timeline = run.build(f"test_push_{compensate}", "servo_cp")
    tip = run_timeline(timeline, ROBOT, as_built(), FOLDER, control)["y0"].tip
    moved = np.linalg.norm(tip[1] - tip[0])
    assert moved > 0.8e-3 if not compensate else moved < 0.03e-3


def test_a_refused_command_stops_the_test_and_says_why():
    """A jump the robot refuses: nothing is evaluated."""
    run = Builder(home(ROBOT), ROBOT.control_period, dwell=0.4)
    run.move(home(ROBOT) + np.array([0.02, 0.0, 0.0]), 0.01)
    run.picture("xz", 0)
    with pytest.raises(BenchtopStopped, match="step too large"):
        run_timeline(run.build("test_jump", "servo_cp"), ROBOT, [], FOLDER)
