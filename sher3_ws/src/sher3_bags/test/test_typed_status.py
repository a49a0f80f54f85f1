"""Typed statuses: read back by an independent reader, and the same definitions as in the interface packages."""

import json
from pathlib import Path

import pytest
from rosbags.highlevel import AnyReader
from sher3_bags import Recorder, read_run
from sher3_bags.codec.pack import text
from sher3_bags.messages import DEFINITIONS, field_lines
from sher3_bags.recording.beside import Beside
from sher3_bags.recording.typed_status import SOURCES, TypedStatuses
from sher3_description import load_robot

INTERFACES = Path(__file__).parents[3] / "interfaces"
FAULT = {
    "code": "WRENCH_STALE",
    "source": "force/measured_cf",
    "value": 0.02,
    "limit": 0.01,
    "unit": "s",
    "action": "STOP",
}
SUPERVISOR = {
    "state": "FAULT", "since": 3_000_000_007, "reason": "WRENCH_STALE", "first_fault": FAULT, "later_faults": 2,
    "action": "STOP", "is_homed": True, "refused": {"error": "StateCommandRefused", "text": "enable is refused"},
}  # fmt: skip
MOTION = {
    "mode": None, "since": 5, "reason": "NOT_ENABLED", "text": "…", "limited_by": "", "is_busy": True,
    "rcm_deviation": None, "singularity": None, "refused": None,
}  # fmt: skip
SETTINGS = {"version": 3, "rcm": [0.1, 0.2, 0.3], "regime": "free", "settings": {"speed": 0.5, "regime": "free"}}


@pytest.fixture
def recorded(tmp_path):
    """Return the typed messages of a bag, newest by topic."""
    robot = load_robot()
    with Recorder(tmp_path / "bag", robot, beside=Beside(robot)) as recorder:
        texts = {"motion/status": MOTION, "supervisor/status": SUPERVISOR, "motion/settings": SETTINGS}
        for k, (topic, content) in enumerate(texts.items()):
            recorder.write(topic, text(json.dumps(content)), 9_000_000_000 + k)
        recorder.write("admittance/status", text("no json"), 9_000_000_009)
    with AnyReader([tmp_path / "bag"]) as reader:
        found = {c.topic: reader.deserialize(raw, c.msgtype) for c, _, raw in reader.messages() if "typed" in c.topic}
    return tmp_path / "bag", found


def test_another_reader_reads_what_the_texts_say(recorded):
    _, found = recorded
    status = found["/sher3/typed/supervisor_status"]
    assert (status.state, status.reason, status.later_faults) == ("FAULT", "WRENCH_STALE", 2)
    assert (status.header.stamp.sec, status.since.sec, status.since.nanosec) == (9, 3, 7)
    assert (status.first_fault.value, status.first_fault.limit, status.first_fault.unit) == (0.02, 0.01, "s")
    assert status.refused.text == "enable is refused"
    settings = found["/sher3/typed/motion_settings"]
    assert list(settings.names) == ["settings.speed"] and list(settings.values) == [0.5]
    assert settings.has_remote_centre and settings.remote_centre.z == 0.3 and settings.regime == "free"


def test_the_operating_state_is_that_of_crtk(recorded):
    state = recorded[1]["/sher3/typed/operating_state"]
    assert state.__msgtype__ == "crtk_msgs/msg/OperatingState"
    assert (state.state, state.is_homed, state.is_busy) == ("FAULT", True, True)


def test_garbage_has_no_typed_twin_and_the_bag_reads_as_before(recorded):
    bag, found = recorded
    assert not {"/sher3/typed/admittance_status", "/sher3/typed/admittance_settings"} & set(found)
    run = read_run(bag, check=False)
    assert json.loads(run["supervisor/status"].data[0]) == SUPERVISOR


def test_ticks_are_typed_too(tmp_path):
    robot = load_robot()
    with Recorder(tmp_path / "bag", robot, beside=Beside(robot)) as recorder:
        recorder.write("admittance/inputs", text("7 3000000009 1 2 -1 1 0 4"), 0)
        recorder.write("motion/inputs", text("8 3000000009 -1 2 0 7 44 5"), 1)
        recorder.write("motion/inputs", text("8 9 -1 2 0 7 44"), 2)
    with AnyReader([tmp_path / "bag"]) as reader:
        law, motion = (reader.deserialize(raw, c.msgtype) for c, _, raw in reader.messages() if "tick" in c.topic)
    assert (law.header.stamp.sec, law.header.stamp.nanosec, law.header.frame_id) == (3, 9, "")
    assert (law.tick, law.wrench_stamp, law.pedal_stamp, law.joints_stamp) == (7, 1, 2, -1)
    assert (law.enabled, law.owner, law.version) == (True, False, 4)
    assert (motion.tick, motion.joints_stamp, motion.twist_stamp, motion.enabled) == (8, -1, 2, False)
    assert (motion.mode, motion.reason, motion.version) == (7, 44, 5)


def test_every_text_has_a_type():
    assert {f"sher3_msgs/{kind}" for kind, _ in SOURCES.values()} <= set(DEFINITIONS)
    assert TypedStatuses().follow("motion/status", "[]", 0) == []
    assert Beside(load_robot()).follow("admittance/settings", b"\x00", 0) == []


@pytest.mark.skipif(not INTERFACES.is_dir(), reason="the interface packages are not beside the sources")
@pytest.mark.parametrize("path", sorted(INTERFACES.glob("*/msg/*.msg")), ids=lambda path: path.stem)
def test_the_definitions_are_those_of_the_interface_packages(path):
    ours = DEFINITIONS[f"{path.parts[-3]}/{path.stem}"]
    assert field_lines(path.read_text()) == field_lines(ours)
