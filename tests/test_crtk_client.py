"""A client written from the CRTK convention alone: it knows names, types and units, and nothing of this project.

Convention: collaborative-robotics.github.io, "Robot API: motion" and "operating states". `crtk_msgs` is not among the
wheels; state commands are `std_msgs/String` here, which is the one thing the client is told.
"""

from __future__ import annotations

import json
from functools import partial

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped, TwistStamped
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from robot_rig import ROBOT, RobotRig
from sensor_msgs.msg import JointState
from sher3_bags.recording.live import recorded
from sher3_runtime import Graph
from std_msgs.msg import String

pytestmark = pytest.mark.graph
JOINTS = ["delta_1", "delta_2", "delta_3", "roll", "tilt"]
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class CrtkClient(Node):
    """Commands and measurements of an arm under `/sher3`."""

    def __init__(self, **options):
        super().__init__("crtk_client", namespace="/sher3", **options)
        self.servo_jp = self.create_publisher(JointState, "servo_jp", 10)
        self.servo_jv = self.create_publisher(JointState, "servo_jv", 10)
        self.servo_cp = self.create_publisher(PoseStamped, "servo_cp", 10)
        self.servo_cv = self.create_publisher(TwistStamped, "servo_cv", 10)
        self.move_jp = self.create_publisher(JointState, "move_jp", 10)
        self.move_cp = self.create_publisher(PoseStamped, "move_cp", 10)
        self.state_command = self.create_publisher(String, "state_command", 10)
        self.newest = {}
        for kind, name, quality in (
            (JointState, "measured_js", 10),
            (PoseStamped, "measured_cp", 10),
            (TwistStamped, "measured_cv", 10),
            (JointState, "goal_js", LATCHED),
            (PoseStamped, "goal_cp", LATCHED),
            (String, "operating_state", LATCHED),
            (String, "motion/status", LATCHED),
            (String, "error", 10),
        ):
            self.create_subscription(kind, name, partial(self.newest.__setitem__, name), quality)

    def joints(self, names=JOINTS, **values):
        """Return a command for joints, by default for all, stamped with the time of the newest measurement."""
        command = JointState(name=names, **values)
        command.header.stamp = self.newest["measured_js"].header.stamp
        return command


@pytest.fixture
def arm(bag_folder):
    with Graph(period=ROBOT.control_period) as graph:
        RobotRig(graph, robot=ROBOT)
        with recorded(graph, bag_folder.name, robot=ROBOT):
            client = graph.add(CrtkClient)
            graph.step(100)
            yield graph, client


def enabled(graph, client):
    client.state_command.publish(String(data="enable"))
    graph.step(300)
    assert client.newest["operating_state"].data == "ENABLED"
    return client.newest["measured_js"]


def test_advertising_every_command_stops_nothing_and_servo_jv_moves_the_joint(arm):
    graph, client = arm
    before = enabled(graph, client)
    assert list(before.name) == JOINTS
    for _ in range(100):
        client.servo_jv.publish(client.joints(velocity=[0.001, 0.0, 0.0, 0.0, 0.0]))
        graph.step()
    after = client.newest["measured_js"]
    assert after.position[0] - before.position[0] == pytest.approx(100 * ROBOT.control_period * 0.001, rel=0.2)
    assert max(abs(a - b) for a, b in zip(after.position[1:3], before.position[1:3], strict=True)) < 5e-6
    assert client.newest["operating_state"].data == "ENABLED"


def test_a_moving_joint_has_a_measured_velocity_and_the_tip_a_twist(arm):
    graph, client = arm
    enabled(graph, client)
    joint, tip = [], []
    for tick in range(150):
        client.servo_jv.publish(client.joints(velocity=[0.0, 0.0, 0.0, 0.02, 0.0]))
        graph.step()
        if tick >= 50:
            joint.append(client.newest["measured_js"].velocity)
            tip.append(client.newest["measured_cv"])
    assert np.mean(joint, axis=0) == pytest.approx([0.0, 0.0, 0.0, 0.02, 0.0], abs=1e-3)
    assert tip[0].header.frame_id == "b"
    assert np.mean([t.twist.angular.x for t in tip]) == pytest.approx(np.mean(joint, axis=0)[3], abs=1e-9)


def test_move_jp_goes_there_and_stops(arm):
    graph, client = arm
    start = enabled(graph, client)
    goal = [start.position[0] + 2e-4, *start.position[1:]]
    client.move_jp.publish(client.joints(position=goal))
    graph.step(500)
    assert list(client.newest["measured_js"].position) == pytest.approx(goal, abs=5e-6)
    assert client.newest["measured_cp"].header.frame_id == "b"
    assert list(client.newest["goal_js"].position) == goal and "goal_cp" not in client.newest


def test_a_command_that_is_none_comes_back_as_a_result(arm):
    """Part of the joints, or no frame: an error as it happens, and the same in the status until one is taken."""
    graph, client = arm
    start = enabled(graph, client)
    wrong = {
        "move_jp": (client.joints(["roll"], position=[0.1]), "value roll; limit delta_1"),
        "move_cp": (PoseStamped(), "frame_id; value ''; limit 'b'"),
    }
    for name, (command, why) in wrong.items():
        getattr(client, name).publish(command)
        graph.step(100)
        error, refused = client.newest["error"].data, json.loads(client.newest["motion/status"].data)["refused"]
        assert error.startswith(f"{name} rejected: ") and why in error
        assert (refused["command"], refused["text"]) == (name, error)
    assert not {"goal_js", "goal_cp"} & set(client.newest)
    client.move_cp.publish(here := client.newest["measured_cp"])
    graph.step(20)
    assert client.newest["goal_cp"].pose == here.pose
    assert json.loads(client.newest["motion/status"].data)["refused"] is None
    assert client.newest["measured_js"].position[3] == pytest.approx(start.position[3], abs=1e-5)


def test_joints_may_be_named_in_any_order(arm):
    graph, client = arm
    start = enabled(graph, client)
    goal = [start.position[0] + 2e-4, *start.position[1:]]
    client.move_jp.publish(client.joints(JOINTS[::-1], position=goal[::-1]))
    graph.step(500)
    assert list(client.newest["measured_js"].position) == pytest.approx(goal, abs=5e-6)
