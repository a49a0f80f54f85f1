"""Two robots in one ROS domain, each in a namespace of its own: neither hears the other."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from xml.etree import ElementTree

import pytest
from sher3_bags import read_run
from sher3_bags.recording.live import recorded
from sher3_bags.recording.robot_frames import RobotFrames
from sher3_bringup.stepped_robot import SteppedRobot
from sher3_common.namespace import NAMESPACE_VARIABLE
from sher3_common.samples import JointSample, TextSample
from sher3_description import load_robot
from sher3_runtime import Graph
from sher3_runtime.ports import NODE_OPTIONS

pytestmark = pytest.mark.graph
NAMES = ("left", "right")


@pytest.fixture
def within(monkeypatch):
    """Return `within(name)`, in whose block this process is in the namespace, as the processes of a robot are."""

    @contextmanager
    def block(name: str) -> Iterator[None]:
        with monkeypatch.context() as patch:
            patch.setenv(NAMESPACE_VARIABLE, f"/{name}")
            patch.setitem(NODE_OPTIONS, "namespace", f"/{name}")
            yield

    return block


def test_one_robot_moves_and_its_neighbour_in_the_domain_hears_nothing(within, bag_folder):
    graphs, probes = {}, {}
    for name in NAMES:
        with within(name):
            graphs[name] = Graph()
            SteppedRobot(graphs[name])
            probes[name] = graphs[name].probe(
                "measured_js", "operating_state", "diagnostics", sends=("command/state_command", "command/servo_jv")
            )
    try:
        with within("left"), recorded(graphs["left"], bag_folder.name) as recorder:
            graphs["left"].step(100)
            probes["left"].send("command/state_command", TextSample("enable"))
            graphs["left"].step(200)
            for _ in range(50):
                stamp = graphs["left"].step()
                probes["left"].send("command/servo_jv", JointSample(stamp, None, (1e-3, 0.0, 0.0, 0.0, 0.0)))
            names = {name for name, _ in probes["left"].get_topic_names_and_types()}
        with within("right"):
            graphs["right"].step(350)
    finally:
        for graph in graphs.values():
            graph.close()
    states = {name: probes[name].samples["operating_state"][-1].text for name in NAMES}
    assert states == {"left": "ENABLED", "right": "DISABLED"}
    moved = {name: probes[name].samples["measured_js"] for name in NAMES}
    assert moved["left"][-1].position[0] - moved["left"][300].position[0] > 5e-5
    assert abs(moved["right"][-1].position[0] - moved["right"][0].position[0]) < 2e-6
    assert {"/left/measured_js", "/right/servo_jv", "/left/diagnostics"} <= names
    assert not [name for name in names if name.startswith("/sher3")]
    run = read_run(recorder.recorder.folder)
    assert run["measured_cp"].frame_id == "left_b" and len(run["measured_js"]) > 300


def test_frames_and_joints_have_the_prefix_of_the_namespace(within):
    with within("left"):
        frames = RobotFrames(load_robot())
        description, _ = frames.fixed(0)
        states = frames.state(0, (0.0,) * 5)
    root = ElementTree.fromstring(description.data[8:].rstrip(b"\0").decode())
    assert all(element.get("name", "").startswith("left_") for tag in ("link", "joint") for element in root.iter(tag))
    assert all(element.get("link", "").startswith("left_") for tag in ("parent", "child") for element in root.iter(tag))
    assert [made.topic for made in states] == ["/joint_states", "/tf", "/sher3/markers"]
    assert all(b"left_" in made.data for made in states)
