"""The running robot as ROS viewers expect it: what `sher3 state` publishes, heard by another node."""

import json
import time
from importlib.util import find_spec

import pytest
from sher3_common.samples import JointSample, TextSample
from sher3_description import load_robot
from sher3_kinematics import RobotKinematics
from sher3_kinematics.model_joints import MODEL_JOINTS, model_positions

pytestmark = pytest.mark.graph
ROBOT = load_robot()
Q = (0.002, -0.001, 0.0015, 0.2, -0.003)


def heard(subscription, kind, patience=5.0):
    """Return the next message of a subscription that no executor serves."""
    end = time.monotonic() + patience
    while time.monotonic() < end:
        if (taken := subscription.handle.take_message(kind, False)) is not None:
            return taken[0]
        time.sleep(0.01)
    raise AssertionError("nothing came")


def test_description_joint_states_and_legs_are_published():
    from rclpy.node import Node
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from sensor_msgs.msg import JointState
    from sher3_runtime import Graph, advertise
    from sher3_runtime.ports import NODE_OPTIONS
    from sher3_view.live.state_node import StateNode
    from std_msgs.msg import String
    from visualization_msgs.msg import Marker

    class Outside(Node):
        def __init__(self, **options):
            super().__init__("outside", **{**NODE_OPTIONS, **options})
            latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            self.say = advertise(self, "measured_js")
            self.states = self.create_subscription(JointState, "/joint_states", print, 10)
            self.legs = self.create_subscription(Marker, "/sher3/markers", print, 10)
            self.description = self.create_subscription(String, "/robot_description", print, latched)

    with Graph(period=ROBOT.control_period) as graph:
        outside = graph.add(Outside)
        node = graph.add(StateNode, ROBOT)
        assert "<visual>" in heard(outside.description, String).data
        for k in range(200):
            outside.say(JointSample(1_000_000 * (k + 1), Q))
            node.step()
            if node.count_subscribers("/joint_states") and (
                taken := outside.states.handle.take_message(JointState, False)
            ):
                break
            time.sleep(0.02)
        state = taken[0]
        assert tuple(state.name) == MODEL_JOINTS
        assert tuple(state.position) == pytest.approx(model_positions(RobotKinematics(ROBOT), Q), abs=1e-15)
        assert len(heard(outside.legs, Marker).points) == 12
        assert all(name in ("/tf", "/tf_static") or "/typed/" in name for name in node.left_out)


@pytest.mark.skipif(find_spec("crtk_msgs") is None, reason="`make messages` has not been run: nobody can hear them")
def test_the_operating_state_is_published_as_crtk_says():
    from crtk_msgs.msg import OperatingState
    from rclpy.node import Node
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from sher3_runtime import Graph, advertise
    from sher3_runtime.ports import NODE_OPTIONS
    from sher3_view.live.state_node import StateNode

    class Client(Node):
        def __init__(self, **options):
            super().__init__("client", **{**NODE_OPTIONS, **options})
            latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            self.say = advertise(self, "supervisor/status")
            self.state = self.create_subscription(OperatingState, "/sher3/typed/operating_state", print, latched)

    status = {"state": "PAUSED", "since": 0, "reason": "pause", "later_faults": 0, "action": "NONE", "is_homed": True}
    with Graph(period=ROBOT.control_period) as graph:
        client = graph.add(Client)
        node = graph.add(StateNode, ROBOT)
        client.say(TextSample(json.dumps(status)))
        for _ in range(100):
            time.sleep(0.02)
            node.step()
            if "/sher3/typed/operating_state" not in node.left_out and client.count_publishers(
                "/sher3/typed/operating_state"
            ):
                break
        assert heard(client.state, OperatingState).state == "PAUSED"


def test_the_layouts_of_the_viewers_name_topics_that_exist():
    import re
    from pathlib import Path

    from sher3_common import read_yaml
    from sher3_description import TOPICS

    folder = Path(__file__).parents[1] / "viewers"
    made = {"/robot_description", "/sher3/markers"}
    known = made | {topic.recorded_name for topic in TOPICS.values()}
    rviz = read_yaml(folder / "sher3.rviz")
    shown = [d.get("Topic", d.get("Description Topic")) for d in rviz["Visualization Manager"]["Displays"]]
    assert {topic["Value"] for topic in shown if topic} <= known
    foxglove = (folder / "foxglove.json").read_text()
    json.loads(foxglove)
    assert set(re.findall(r"(/(?:sher3/[a-z_/]+|robot_description))", foxglove)) <= known
