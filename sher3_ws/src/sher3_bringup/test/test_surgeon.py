"""The scripted surgeon and the keyboard, without ROS."""

import json
import math
import re
import struct
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sher3_bringup.errors import ConfigurationError
from sher3_bringup.surgeon.device import Device
from sher3_bringup.surgeon.keyboard import FORCE_LIMIT, HELP, KEYS, TORQUE_LIMIT, Keyboard
from sher3_bringup.surgeon.panel import panel_lines
from sher3_bringup.surgeon.script import demo_script, load_script
from sher3_bringup.surgeon.teleop import is_over
from sher3_bringup.terminal.status_news import StatusNews
from sher3_common import FileError
from sher3_common.samples import JointSample, PoseSample, TextSample, WrenchSample
from sher3_view.live.snapshot import Snapshot

SCRIPT = load_script(demo_script())


def test_the_demo_reaches_holds_dithers_releases_and_arms_again():
    names = [step.name for step in SCRIPT.steps]
    assert [n for n in names if n in ("reach", "hold", "dither", "release", "re-arm")] == [
        "reach",
        "hold",
        "dither",
        "release",
        "re-arm",
    ]
    assert 15.0 < SCRIPT.duration < 25.0
    assert [step.command for step in SCRIPT.steps if step.command] == ["enable", "disable"]


def test_the_hand_is_smooth():
    """No jump of pedal or force between two ticks, also where steps meet."""
    times = [k * 0.002 for k in range(int(SCRIPT.duration / 0.002))]
    for (pedal_a, wrench_a), (pedal_b, wrench_b) in pairwise(map(SCRIPT.at, times)):
        assert abs(pedal_b - pedal_a) < 0.02
        assert math.dist(wrench_a, wrench_b) < 0.05


@given(st.floats(min_value=0.0, max_value=100.0))
def test_pedal_and_wrench_stay_in_range(time):
    pedal, wrench = SCRIPT.at(time)
    assert 0.0 <= pedal <= 1.0
    assert all(abs(component) < 20.0 for component in wrench)


def test_the_released_pedal_stays_released():
    start = sum(step.duration for step in SCRIPT.steps[:6])
    assert SCRIPT.steps[6].name == "release"
    assert all(SCRIPT.at(start + SCRIPT.steps[6].ramp + 0.01 * k)[0] == 0.0 for k in range(100))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("schema: sher3.teleop/1\nsteps: []", "steps"),
        ("schema: sher3.teleop/2\nsteps: [{name: a, duration: 1}]", "schema"),
        ("schema: sher3.teleop/1\nsteps: [{name: a, duration: -1}]", "steps.0.duration.*-1"),
        ("schema: sher3.teleop/1\nsteps: [{name: a, duration: 1, pedal: 2}]", "pedal.*value 2"),
        ("schema: sher3.teleop/1\nsteps: [{name: a, duration: 1, wrench: [1, 2]}]", "wrench"),
        ("schema: sher3.teleop/1\nsteps: [{name: a, duration: 1, wrench: [99, 0, 0, 0, 0, 0]}]", "wrench.0.*value 99"),
        ("schema: sher3.teleop/1\nsteps: [{name: a, duration: .inf}]", "duration"),
        ("schema: sher3.teleop/1\nsteps: [{name: a, duration: 1, command: fly}]", "command.*value fly"),
        ("schema: sher3.teleop/1\nsteps: [{name: a, duration: 1, peddal: 1}]", "peddal"),
    ],
)
def test_bad_scripts_name_the_step(tmp_path, text, message):
    path = tmp_path / "script.yaml"
    path.write_text(text)
    with pytest.raises(ConfigurationError, match=message):
        load_script(path)


def test_a_script_that_is_not_there(tmp_path):
    with pytest.raises(FileError, match="no such file"):
        load_script(tmp_path / "none.yaml")


@given(st.text(alphabet="wsadrfikjluo pex?", max_size=300))
def test_no_key_leaves_the_limits(keys):
    keyboard = Keyboard()
    for key in keys:
        keyboard.press(key)
    pedal, wrench = keyboard.hands(0.0)
    assert pedal in (0.0, 1.0)
    assert all(abs(f) <= FORCE_LIMIT + 1e-12 for f in wrench[:3])
    assert all(abs(m) <= TORQUE_LIMIT + 1e-12 for m in wrench[3:])


def test_what_a_key_asks_for_is_sent_once():
    keyboard = Keyboard()
    for key in "ezcgGhHt?":
        keyboard.press(key)
    texts = [asked.text for asked in keyboard.asked()]
    assert texts == ["enable", "pause", "resume", "near_tissue", "free", "here 0.018", "off", ""]
    assert keyboard.asked() == []


def test_every_key_stands_in_the_help():
    for key in KEYS:
        assert re.search(rf"(?<!\w){key} [a-z]", HELP), key


def heard(**statuses):
    """A robot at rest under 1 N, with the given statuses."""
    snapshot = Snapshot.empty()
    samples = {
        "measured_js": JointSample(10**9, (0.0,) * 5),
        "measured_cp": PoseSample(10**9, (0.17, 0.0, 0.1), (0.0, 0.0, 0.0, 1.0)),
        "force/measured_cf": WrenchSample(10**9, (1.0, 0, 0, 0, 0, 0)),
        **{name: TextSample(json.dumps(status)) for name, status in statuses.items()},
    }
    snapshot.take({name: lambda sample=sample: sample for name, sample in samples.items()})
    return snapshot


def test_the_panel_tells_state_tip_force_and_refusal():
    statuses = {
        "supervisor/status": {"state": "PAUSED", "reason": "pause", "refused": {"text": "enable refused in PAUSED"}},
        "motion/settings": {"regime": "free", "rcm": [0.2, 0.0, 0.1], "settings": {"free_speed": 0.005}},
    }
    lines = panel_lines(heard(**statuses), "pedal released", "tare done", 10**9, 200)
    assert lines[0] == "state   PAUSED: since pause"
    assert "+170.000" in lines[1] and "cap 5" in lines[1]
    assert "force 1.00 N" in lines[2] and "regime free" in lines[2] and "+200.0 +0.0 +100.0 mm" in lines[2]
    assert lines[4:] == ["answer  tare done", "refused enable refused in PAUSED"]
    assert all(len(line) < 40 for line in panel_lines(heard(**statuses), "pedal released", "", 10**9, 40))


def test_the_panel_tells_a_fault_with_its_number_and_that_nobody_is_there():
    fault = {"code": "WRENCH_STALE", "source": "force", "value": 0.02, "limit": 0.01, "unit": "s"}
    status = {"state": "FAULT", "reason": "WRENCH_STALE", "first_fault": fault}
    line = panel_lines(heard(**{"supervisor/status": status}), "", "", 3 * 10**9)[0]
    assert line == "state   FAULT: WRENCH_STALE force: 0.02 s, limit 0.01 s; the joints are 2.0 s old"
    assert "no robot is heard" in panel_lines(Snapshot.empty(), "", "", 0)[0]


def test_a_joystick_is_hand_and_foot(tmp_path):
    """Half to the left pushes along +y, a button is the pedal; a stick that does not quite return does nothing."""
    events = [(0, -16384, 0x02, 0), (0, 900, 0x82, 1), (0, 1, 0x01, 3)]
    (tmp_path / "js0").write_bytes(b"".join(struct.pack("<IhBB", *event) for event in events))
    pedal, wrench = Device(tmp_path / "js0").hands(0.0)
    assert pedal == 1.0 and wrench == pytest.approx((0.0, 1.0, 0, 0, 0, 0), abs=1e-4)


def test_a_spacemouse_is_hand_and_foot(tmp_path):
    """Pushed down at the end of its travel it presses along -z; the button is let go again."""
    events = [(0x02, 2, 350), (0x01, 256, 1), (0x01, 256, 0), (0x04, 4, 7)]
    (tmp_path / "event5").write_bytes(b"".join(struct.pack("<qqHHi", 0, 0, *event) for event in events))
    device = Device(tmp_path / "event5")
    pedal, wrench = device.hands(0.0)
    assert pedal == 0.0 and wrench == pytest.approx((0, 0, -2.0, 0, 0, 0))
    device.close()
    with pytest.raises(ConfigurationError, match="plug it in"):
        Device(tmp_path / "js7")


def test_a_script_ends_early_where_no_robot_is_heard():
    script, told = load_script(demo_script()), StatusNews()
    assert [is_over(script, told, elapsed) for elapsed in (0.0, 4.9, 5.0)] == [False, False, True]
    told.hear("supervisor/status", {"state": "DISABLED", "since": 0, "reason": "start"})
    assert [is_over(script, told, elapsed) for elapsed in (5.0, script.duration)] == [False, True]
