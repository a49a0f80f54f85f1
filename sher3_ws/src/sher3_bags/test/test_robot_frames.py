"""What a viewer needs beside the streams: read back by an independent reader, checked against the kinematics."""

import math

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from scipy.spatial.transform import Rotation
from sher3_bags import Recorder, read_run
from sher3_bags.codec.pack import joint_state
from sher3_bags.messages import schema_text
from sher3_bags.recording.beside import Beside
from sher3_bags.recording.robot_frames import RobotFrames
from sher3_description import ACTUATORS, load_robot
from sher3_description.topics import TOPICS
from sher3_kinematics import RobotKinematics

ROBOT = load_robot()
Q = (0.002, -0.001, 0.0015, 0.2, -0.003)


def message(stamp, q=Q):
    return joint_state(stamp, ACTUATORS, q)


@pytest.fixture
def opened(tmp_path):
    with Recorder(tmp_path / "bag", ROBOT, beside=Beside(ROBOT)) as recorder:
        for k in range(26):
            recorder.write("measured_js", message(1_000_000_000 + 4_000_000 * k), 5 + k)
    with AnyReader([tmp_path / "bag"]) as reader:
        yield tmp_path / "bag", [(c.topic, reader.deserialize(raw, c.msgtype)) for c, _, raw in reader.messages()]


def test_a_state_every_twenty_milliseconds_and_one_description(opened):
    _, messages = opened
    count = {topic: sum(t == topic for t, _ in messages) for topic, _ in messages}
    assert count == {
        "/sher3/measured_js": 26, "/robot_description": 1, "/tf_static": 1,
        "/joint_states": 6, "/tf": 6, "/sher3/markers": 6,
    }  # fmt: skip
    states = [m for t, m in messages if t == "/joint_states"]
    assert [s.header.stamp.nanosec for s in states] == [0, 20_000_000, 40_000_000, 60_000_000, 80_000_000, 100_000_000]


def test_the_transforms_lead_to_the_tip(opened):
    _, messages = opened
    frames = {}
    for topic, found in messages:
        if topic in ("/tf", "/tf_static"):
            frames |= {t.child_frame_id: t for t in found.transforms}
    transform, frame = np.eye(4), "t"
    while frame != "b":
        entry = frames[frame].transform
        step = np.eye(4)
        step[:3, 3] = entry.translation.x, entry.translation.y, entry.translation.z
        r = entry.rotation
        step[:3, :3] = Rotation.from_quat([r.x, r.y, r.z, r.w]).as_matrix()
        transform, frame = step @ transform, frames[frame].header.frame_id
    np.testing.assert_allclose(transform, RobotKinematics(ROBOT).transform_tip_to_base(Q), atol=1e-12)


def test_every_leg_has_its_length(opened):
    _, messages = opened
    marker = next(m for t, m in messages if t == "/sher3/markers")
    assert marker.header.frame_id == "b" and marker.type == 5
    ends = np.array([[p.x, p.y, p.z] for p in marker.points]).reshape(6, 2, 3)
    np.testing.assert_allclose(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), ROBOT.delta.link_length, atol=1e-12)


def test_every_transform_is_of_a_link_of_the_description(opened):
    _, messages = opened
    text = next(m.data for t, m in messages if t == "/robot_description")
    children = {x.child_frame_id for t, m in messages if t in ("/tf", "/tf_static") for x in m.transforms}
    assert all(f'link="{child}"' in text for child in children)
    state = next(m for t, m in messages if t == "/joint_states")
    assert all(f'name="{name}"' in text for name in state.name)
    assert state.position[6] == 0.2 and math.isfinite(state.position[7])


def test_the_robot_is_read_as_before(opened):
    folder, _ = opened
    run = read_run(folder, check=False)
    assert set(run.streams) == {"measured_js"}


def test_a_position_that_no_leg_reaches_has_no_state():
    frames = RobotFrames(ROBOT)
    assert frames.follow(message(1, (0.0, 0.5, 0.0, 0.0, 0.0))) == []
    assert frames.follow(joint_state(10**9, ("one",), (0.0,))) == []


def test_bytes_that_are_no_message_have_no_state():
    whole = message(1_000_000_000)
    for spoilt in (b"", whole[:9], whole[:30], whole[:12] + b"\xff" * 40):
        assert RobotFrames(ROBOT).follow(spoilt) == []


def test_nothing_that_is_recorded_needs_a_message_package(monkeypatch):
    """A wheel may be installed where the message files of ROS are not; a recorder that stops stops the robot."""
    made = [m for x in (RobotFrames(ROBOT).fixed(0), RobotFrames(ROBOT).state(0, Q)) for m in x]
    schema_text.cache_clear()
    monkeypatch.setattr("sys.prefix", "/nowhere")
    for kind in {topic.type for topic in TOPICS.values()} | {m.type for m in made}:
        assert schema_text(kind)
