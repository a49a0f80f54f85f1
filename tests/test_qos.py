"""Quality of service, types and names of every endpoint, read back from the running graph."""

from __future__ import annotations

import pytest
from rclpy.qos import QoSCompatibility, qos_check_compatible
from robot_rig import ROBOT, RobotRig
from sher3_bags.recording.recorder_node import RecorderNode
from sher3_bringup.surgeon.script import demo_script, load_script
from sher3_bringup.surgeon.teleop_node import script_node
from sher3_description import TOPICS
from sher3_description.topics import MANY_SENDERS
from sher3_gap.live.gap_monitor_node import GapMonitorNode
from sher3_runtime import Graph

pytestmark = pytest.mark.graph
OUTSIDE = {"/parameter_events", "/rosout"}
USER = {name for name in TOPICS if name.startswith("command/")} | {
    "mock/effects",
    "mock/fault",
    "mock/force_device",
    "mock/pedal_device",
}
"""Topics whose publisher is a user or another program."""


@pytest.fixture
def endpoints(tmp_path):
    """Return publishers and subscribers of every topic of a graph with every node in it."""
    with Graph(period=ROBOT.control_period) as graph:
        RobotRig(graph)
        graph.add(RecorderNode, tmp_path / "bag", ROBOT)
        graph.add(GapMonitorNode, ROBOT)
        graph.add(script_node, load_script(demo_script()))
        graph.step(3)
        node = graph.nodes[0]
        names = {name for name, _ in node.get_topic_names_and_types()} - OUTSIDE
        yield {
            name: (node.get_publishers_info_by_topic(name), node.get_subscriptions_info_by_topic(name))
            for name in names
        }


def test_every_pair_is_compatible(endpoints):
    """An incompatible pair is silent: it has to be found here."""
    pairs = 0
    for name, (publishers, subscribers) in endpoints.items():
        for publisher in publishers:
            for subscriber in subscribers:
                verdict, reason = qos_check_compatible(publisher.qos_profile, subscriber.qos_profile)
                ends = f"{name}: {publisher.node_name} -> {subscriber.node_name}: {reason}"
                assert verdict == QoSCompatibility.OK, ends
                pairs += 1
    assert pairs > 30


def test_names_and_types_are_those_of_the_table(endpoints):
    by_name = {topic.full_name: topic for topic in TOPICS.values()}
    assert set(endpoints) <= set(by_name)
    for name, (publishers, subscribers) in endpoints.items():
        for end in (*publishers, *subscribers):
            assert end.topic_type == by_name[name].type, f"{name}: {end.node_name}"


def test_every_topic_of_the_table_is_published_and_recorded(endpoints):
    for name, topic in TOPICS.items():
        publishers, subscribers = endpoints[topic.full_name]
        assert publishers or name in USER, f"nobody publishes {name}"
        assert any("recorder" in end.node_name for end in subscribers), f"nobody records {name}"


def test_each_robot_stream_has_one_publisher(endpoints):
    for name, topic in TOPICS.items():
        publishers, _ = endpoints[topic.full_name]
        if name not in USER | MANY_SENDERS:
            assert len(publishers) == 1, f"{name}: {[end.node_name for end in publishers]}"
