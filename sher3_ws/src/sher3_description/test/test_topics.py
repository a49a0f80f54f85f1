"""The topic table is complete and consistent."""

from sher3_description import TOPICS

CONTRACT = {
    "setpoint_js": "sensor_msgs/msg/JointState",
    "servo_cv": "geometry_msgs/msg/TwistStamped",
    "servo_jv": "sensor_msgs/msg/JointState",
    "drives/setpoint_jv": "sensor_msgs/msg/JointState",
    "drives/measured_js": "sensor_msgs/msg/JointState",
    "measured_js": "sensor_msgs/msg/JointState",
    "measured_cp": "geometry_msgs/msg/PoseStamped",
    "force/measured_cf": "geometry_msgs/msg/WrenchStamped",
    "pedal/measured": "sensor_msgs/msg/Joy",
    "tracker/measured_cp": "geometry_msgs/msg/PoseStamped",
    "temperature": "sensor_msgs/msg/Temperature",
    "operating_state": "std_msgs/msg/String",
}


def test_table_holds_the_contract() -> None:
    assert {name: TOPICS[name].type for name in CONTRACT} == CONTRACT


def test_names_and_frames() -> None:
    assert all(name == topic.name for name, topic in TOPICS.items())
    assert TOPICS["measured_cp"].full_name == "/sher3/measured_cp"
    assert TOPICS["diagnostics"].full_name == "/diagnostics"
    assert TOPICS["measured_cp"].frame_id == TOPICS["servo_cv"].frame_id == "b"
    assert TOPICS["force/measured_cf"].frame_id == "f"


def test_latched_topics_hold_one_sample_and_streams_are_reliable() -> None:
    for topic in TOPICS.values():
        assert topic.qos.reliability == "reliable"
        latched = topic.qos.durability == "transient_local"
        assert latched == (
            topic.name == "operating_state"
            or topic.name.endswith(("/settings", "/status"))
            or topic.name.startswith("goal_")
        )
        assert topic.qos.depth == 1 if latched else topic.qos.depth >= 10
