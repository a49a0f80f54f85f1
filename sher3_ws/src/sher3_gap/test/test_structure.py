"""Structural isolability: what each further topic tells apart."""

from sher3_effects import library
from sher3_gap.stages.isolability import structure

FULL = (
    "setpoint_js",
    "servo_jv",
    "drives/setpoint_jv",
    "drives/measured_js",
    "measured_js",
    "force/measured_cf",
    "tracker/measured_cp",
)


def group(topics, effect):
    return next((g for g in structure(topics).groups if effect in g), set())


def test_every_effect_is_somewhere():
    found = structure(FULL)
    assert set().union(*found.groups) | found.invisible == set(library())
    assert not found.invisible


def test_a_page_that_is_named_later_is_part_of_it(monkeypatch):
    assert "own" not in set().union(*structure(FULL).groups)
    own = {**library(), "own": library()["backlash"]}
    monkeypatch.setattr("sher3_gap.stages.isolability.library", lambda: own)
    assert "own" in group(FULL, "backlash")


def test_the_echo_separates_timing_from_the_drive():
    without = tuple(t for t in FULL if t not in ("servo_jv", "drives/setpoint_jv"))
    assert "drive_lag" in group(without, "command_delay")
    assert "drive_lag" not in group(FULL, "command_delay")
    assert group(FULL, "command_delay") == {"command_delay", "command_jitter", "dropped_commands", "axis_skew"}


def test_without_a_tracker_the_tip_is_invisible():
    without = tuple(t for t in FULL if t != "tracker/measured_cp")
    assert {"tool_offset", "structural_compliance", "link_length_error"} <= structure(without).invisible
    assert "backlash" not in structure(without).invisible


def test_a_load_that_nothing_measures_mixes_mechanics_and_structure():
    without = tuple(t for t in FULL if t != "force/measured_cf")
    hand = next(g for g in structure(without, known_load=False).groups if "coulomb_friction" in g)
    assert "structural_compliance" in hand
    assert "structural_compliance" not in group(without, "coulomb_friction")


def test_without_the_load_encoder_its_errors_look_like_the_controllers():
    without = tuple(t for t in FULL if t != "measured_js")
    assert group(FULL, "encoder_scale") == {"encoder_scale", "encoder_eccentricity"}
    assert group(without, "encoder_scale") == {"encoder_scale", "encoder_eccentricity", "controller_gain"}


def test_without_motor_side_readings_mechanics_and_transmission_are_one():
    without = tuple(t for t in FULL if t != "drives/measured_js")
    assert {"coulomb_friction", "drive_lag"} <= group(without, "backlash")
    assert "coulomb_friction" not in group(FULL, "backlash")


def test_the_load_side_splits_stages_as_measured_on_a_plain_axis():
    groups = structure(FULL).groups
    assert {"command_delay", "command_jitter", "dropped_commands", "axis_skew"} in groups
    assert {"drive_lag", "force_saturation", "velocity_deadband"} in groups
    assert {"controller_gain"} in groups
