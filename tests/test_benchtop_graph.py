"""The bench-top evaluation on the graph: all nodes, CAN frames and plant in stepped time; each test leaves a bag."""

from __future__ import annotations

import json

import numpy as np
import pytest
from sher3_bags.reading import read_run
from sher3_bags.recording.live import bag_folder
from sher3_benchtop.as_built import as_built
from sher3_benchtop.errors import BenchtopStopped
from sher3_benchtop.fixture import bench_robot, home
from sher3_benchtop.graph.runs import run_timeline
from sher3_benchtop.protocol.plan import DOWN, FAST, Grid, Plan, grid_test
from sher3_benchtop.protocol.timeline import Builder
from sher3_control.settings import ControlSettings
from sher3_description import ACTUATORS, load_robot
from sher3_drivers.settings import default_settings
from sher3_kinematics import RobotKinematics
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


def test_a_swing_of_the_push_pushes_the_tilt_off_its_demand_and_stops_no_robot():
    """From 8 N to -6 N along x: 1.8 N at the slider of the tilt per N at the grasp push its drive 130 um off.

    That is twice the limit at rest near a patient. On the bench the drives have the limits of the bench.
    """
    run = Builder(home(ROBOT), ROBOT.control_period, dwell=0.4)
    for force in (FAST.push, FAST.pull):
        run.push([force, 0.0, 0.0])
        run.picture("x0", 0, force)
    run_timeline(run.build("test_swing", "servo_cp"), ROBOT, [], FOLDER)
    error = following_error(read_run(FOLDER / "test_swing"), "tilt")
    assert error == pytest.approx(129e-6, rel=0.03)
    assert error > 2.0 * default_settings(ROBOT.control_period).following_distance


def following_error(run, name: str) -> float:
    """Return the largest integrated demand minus motor motion, less its slow part [m], as the driver's watch has it."""
    axis, settings = ACTUATORS.index(name), default_settings(ROBOT.control_period)
    motor, demand = run["drives/measured_js"].position[:, axis], run["drives/setpoint_jv"].velocity[:, axis]
    keep, error, largest = 1.0 - settings.period / settings.following_memory, 0.0, 0.0
    for moved, speed in zip(np.diff(motor), demand[1:], strict=True):
        error = keep * error + speed * settings.period - moved
        largest = max(largest, abs(error))
    return largest


@pytest.mark.slow
def test_the_deflection_command_of_the_documentation(sher3):
    """The whole command: 45 pictures under load at five places, and the compliances that were put into the robot."""
    done = sher3("benchtop", "--fast", "--test", "deflection", "--json", timeout=280)
    assert done.returncode == 0, done.stderr
    figures = json.loads(done.stdout)
    found = [figures[f"tip/compliance/{axis}/mean"] for axis in "xyz"]
    assert found == pytest.approx([23.13, 279.33, 239.75], abs=0.02)
