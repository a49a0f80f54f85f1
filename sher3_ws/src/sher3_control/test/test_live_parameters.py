"""Live parameters: accepted within range, refused by name, and restored exactly from their record."""

import pytest
from law_bench import SETTINGS
from sher3_control import AxisLock
from sher3_control.errors import SettingsError
from sher3_control.law.live_parameters import apply_command, from_json, live_parameters, to_json, with_bias
from sher3_control.nodes.heard import HeardState, status_of
from sher3_control.tick_records import admittance_record, motion_record, record_text

LIVE = live_parameters(SETTINGS)


def test_commands_change_one_parameter_and_the_version():
    assert apply_command(LIVE, "speed_scale 0", SETTINGS) == LIVE._replace(version=1, speed_scale=0.0)
    assert apply_command(LIVE, "linear_gain 0.002", SETTINGS).linear_gain == 0.002
    assert apply_command(LIVE, "axis_lock needle", SETTINGS).lock is AxisLock.NEEDLE


@pytest.mark.parametrize(
    "text",
    ["", "speed_scale", "speed_scale x", "speed_scale nan", "speed_scale 1.1", "speed_scale -0.1", "linear_gain 1",
     "axis_lock sideways", "colour 3"],
)  # fmt: skip
def test_bad_commands_are_refused_with_a_remedy(text):
    with pytest.raises(SettingsError) as caught:
        apply_command(LIVE, text, SETTINGS)
    assert caught.value.remedy


def test_records_restore_exactly():
    live = with_bias(apply_command(LIVE, "angular_gain 3.3", SETTINGS), (0.1, 1 / 3, 1e-17, 0.0, -0.2, 7.0))
    assert from_json(to_json(live, SETTINGS)) == (live, SETTINGS)
    line = admittance_record("1 2 3 -1 4 1 0 5")
    assert admittance_record(record_text(line)) == line


@pytest.mark.parametrize("text", ["", "{}", "[]", "nonsense", '{"live": {}, "settings": {}}'])
def test_damaged_records_are_named(text):
    with pytest.raises(SettingsError):
        from_json(text)
    with pytest.raises(SettingsError):
        motion_record(text)


def test_a_state_is_believed_only_while_it_is_repeated():
    state = HeardState(0.03)
    assert not state.enabled(0)
    state.feed("ENABLED", 10**9)
    assert state.enabled(10**9 + 30_000_000)
    assert not state.enabled(10**9 + 30_000_001)
    state.feed("ENABLED NONE", 5 * 10**9)
    assert state.enabled(5 * 10**9)
    state.feed("FAULT QUICK_STOP", 5 * 10**9)
    assert not state.enabled(5 * 10**9)


@pytest.mark.parametrize("text", ["", "nonsense", "[1]", "3"])
def test_damaged_statuses_say_nothing(text):
    assert status_of(text) == {}
