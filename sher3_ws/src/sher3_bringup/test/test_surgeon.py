"""The scripted surgeon and the keyboard, without ROS."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sher3_bringup.errors import ConfigurationError
from sher3_bringup.surgeon.keyboard import FORCE_LIMIT, TORQUE_LIMIT, Keyboard
from sher3_bringup.surgeon.script import demo_script, load_script
from sher3_common import FileError

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


def test_a_command_is_sent_once():
    keyboard = Keyboard()
    keyboard.press("e")
    assert [keyboard.command(0.0), keyboard.command(0.0)] == ["enable", ""]
    keyboard.press(" ")
    assert keyboard.changed() and not keyboard.changed()
