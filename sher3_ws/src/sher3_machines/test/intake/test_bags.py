"""Bags of ROS as tables: by topic and field, of every kind of storage, and two bags with different clocks."""

import numpy as np
import pytest
from rosbags.rosbag2 import Writer
from rosbags.rosbag2.enums import StoragePlugin
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from sher3_machines import MachineError, import_case, open_case
from sher3_machines.intake.tables import read_tables

STORE = get_typestore(Stores.ROS2_JAZZY)
TYPES = STORE.types
PERIOD = 0.004


def header(t):
    stamp = TYPES["builtin_interfaces/msg/Time"](sec=int(t), nanosec=round((t % 1) * 1e9))
    return TYPES["std_msgs/msg/Header"](stamp=stamp, frame_id="base")


def vector(x, y, z):
    return TYPES["geometry_msgs/msg/Vector3"](x=x, y=y, z=z)


def messages(t):
    """A message of each of the four types at time t."""
    joints = TYPES["sensor_msgs/msg/JointState"](
        header=header(t),
        name=["elbow", "wrist"],
        position=np.array([np.sin(t), 2.0]),
        velocity=np.array([np.cos(t), 0.0]),
        effort=np.array([5.0 * np.cos(t), 1.0]),
    )
    wrench = TYPES["geometry_msgs/msg/WrenchStamped"](
        header=header(t),
        wrench=TYPES["geometry_msgs/msg/Wrench"](force=vector(1.0, 2.0, t), torque=vector(0.0, 0.0, 3.0)),
    )
    pose = TYPES["geometry_msgs/msg/PoseStamped"](
        header=header(t),
        pose=TYPES["geometry_msgs/msg/Pose"](
            position=TYPES["geometry_msgs/msg/Point"](x=t, y=0.0, z=1.0),
            orientation=TYPES["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0),
        ),
    )
    twist = TYPES["geometry_msgs/msg/TwistStamped"](
        header=header(t),
        twist=TYPES["geometry_msgs/msg/Twist"](linear=vector(t, 0.0, 0.0), angular=vector(0.0, 0.0, 0.1)),
    )
    return {"/arm/joint_states": joints, "/ft": wrench, "/tracker": pose, "/twist": twist}


def bag(path, start=1000.0, seconds=2.0, storage=StoragePlugin.SQLITE3, topics=None, late=0.0):
    with Writer(path, version=9, storage_plugin=storage) as writer:
        connections = {}
        for k in range(int(seconds / PERIOD)):
            t = start + k * PERIOD
            for topic, message in messages(t - late).items():
                if topics is not None and topic not in topics:
                    continue
                kind = message.__msgtype__
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
                stamp = message.header.stamp
                stamp.sec, stamp.nanosec = int(t), round((t % 1) * 1e9)
                writer.write(connections[topic], int(t * 1e9) + 5_000_000, STORE.serialize_cdr(message, kind))
    return path


@pytest.mark.parametrize("storage", [StoragePlugin.SQLITE3, StoragePlugin.MCAP], ids=["sqlite", "mcap"])
def test_topics_are_tables_and_joints_too(tmp_path, storage):
    found = read_tables(bag(tmp_path / "bag", storage=storage))
    assert found["arm/joint_states/elbow/position"][1] == pytest.approx(np.sin(1000.004))
    assert found["arm/joint_states/wrist/effort"][0] == 1.0
    assert found["ft/force"].shape == (500, 3) and found["ft/torque"][0].tolist() == [0.0, 0.0, 3.0]
    assert found["tracker/orientation"][0].tolist() == [0.0, 0.0, 0.0, 1.0]
    assert found["tracker/position"][2, 0] == pytest.approx(1000.008)
    assert found["twist/linear"].shape == found["twist/angular"].shape == (500, 3)
    assert found["ft/stamp"][1] == pytest.approx(1000.004, abs=1e-6)
    assert found["ft/received"][1] - found["ft/stamp"][1] == pytest.approx(0.005, abs=1e-6)


SAMPLES = """float32[] milliseconds
float32[] position
float32[] torque
float32[] gains"""


@pytest.mark.parametrize("entries, rows", [(100, 300), (20, 3)])
def test_samples_sent_in_one_piece_are_rows(tmp_path, entries, rows):
    """Three messages of lists with their own clock; short lists are what joints have at one moment."""
    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(get_types_from_msg(SAMPLES, "tests/msg/Samples"))
    with Writer(tmp_path / "bag", version=9) as writer:
        connection = writer.add_connection("/pan", "tests/msg/Samples", typestore=store)
        for k in range(3):
            t = np.arange(entries, dtype=np.float32) + k * entries
            message = store.types["tests/msg/Samples"](t, np.sin(t), np.cos(t), np.zeros(0, np.float32))
            writer.write(connection, k * 1_000_000_000, store.serialize_cdr(message, "tests/msg/Samples"))
    tables = read_tables(tmp_path / "bag")
    assert len(tables["pan/position"]) == rows and ("pan/received" in tables) == (rows == 3)
    np.testing.assert_allclose(tables["pan/torque"], np.cos(tables["pan/milliseconds"]), atol=1e-6)


def test_an_mcap_file_alone_is_a_bag(tmp_path):
    bag(tmp_path / "bag", storage=StoragePlugin.MCAP)
    found = read_tables(next((tmp_path / "bag").glob("*.mcap")))
    assert found["ft/force"].shape == (500, 3)


DESCRIPTION = """kind: axes
name: elbow
time: {{column: stamp, unit: s, offsets: {offsets}}}
axes:
  - name: elbow
    motion: rotary
    signals:
      position: {{column: robot/arm/joint_states/elbow/position, unit: rad}}
      effort: {{column: robot/arm/joint_states/elbow/effort, unit: N*m}}
      load: {{column: camera/tracker/position, unit: m, index: 1}}
    command_law: {{kind: force}}
    mass: 1.0
    encoder_resolution: 1.0e-4
"""


def test_two_bags_of_two_clocks_are_one_run(tmp_path):
    """The camera's clock is 37.5 s behind that of the robot: its stamps plus the offset are the robot's."""
    run = tmp_path / "run"
    run.mkdir()
    bag(run / "robot", topics=("/arm/joint_states",))
    bag(run / "camera", start=962.5, topics=("/tracker",))
    description = tmp_path / "elbow.yaml"
    description.write_text(DESCRIPTION.format(offsets="{camera: 37.5}"))
    import_case([run], description, tmp_path / "case")
    (_, (found,)) = open_case(tmp_path / "case")
    signals = found.signals["elbow"]
    assert len(signals["position"]) == len(signals["load"]) > 490
    description.write_text(DESCRIPTION.format(offsets="{}"))
    with pytest.raises(MachineError, match=r"overlap.*offsets"):
        import_case([run], description, tmp_path / "other")


@pytest.mark.parametrize("cut", [0, 10, 200, 4000])
def test_a_damaged_bag_is_refused(tmp_path, cut):
    path = bag(tmp_path / "bag", seconds=0.5, storage=StoragePlugin.MCAP)
    file = next(path.glob("*.mcap"))
    file.write_bytes(file.read_bytes()[:cut])
    for damaged in (path, file):
        with pytest.raises(MachineError):
            read_tables(damaged)


def test_a_database_without_its_metadata_is_read(tmp_path):
    bag(tmp_path / "bag")
    (database,) = (tmp_path / "bag").glob("*.db3")
    database.rename(tmp_path / "alone.db3")
    whole = read_tables(tmp_path / "alone.db3")
    assert whole["arm/joint_states/elbow/position"].shape == (500,)
