"""Every page: a complete data sheet, siblings that exist, units on both kinds of axis, a form in the plant."""

import subprocess
import sys

import numpy as np
import pytest
from sher3_diagnosis.channel import STAGES, Channel
from sher3_diagnosis.effect import INPUTS, KINDS, ROTARY
from sher3_effects import computed, every, library, load_effects, pages, plants, save_effects
from sher3_sim.effect import REVOLUTE, SITES

KNOWN = {page.id for kind in KINDS for page in pages(kind)}
EVERY = [pytest.param(page, id=f"{kind}-{page.id}") for kind in KINDS for page in pages(kind)]
ROBOT_PAGES = [pytest.param(page, id=page.id) for page in library().values()]
CONSTANT = {"force_bias"}
"""Effects whose law depends on nothing."""
FACTS = {
    "applied",
    "lead",
    "load",
    "temperature",
    "mass",
    "drive",
    "forces",
    "alone",
    "behind",
    "held",
    "asked speed",
    "orientation",
    "no_lead",
}
RELATIONS = {"", "load_encoder", "both_encoders", "force_sensor"}


@pytest.mark.parametrize("page", EVERY)
def test_the_data_sheet_is_complete(page):
    assert page.stage in STAGES and page.family
    assert page.explanation.endswith(".") and page.best.why
    assert set(page.kinds) <= set(KINDS) and page.places
    assert set(page.inputs) <= set(INPUTS) and (page.inputs or page.id in CONSTANT or page.kinds == ("arm",))
    assert set(page.needs) <= FACTS
    assert page.breaks in RELATIONS
    assert set(page.extends) <= KNOWN
    assert type(page).__doc__


@pytest.mark.parametrize("page", EVERY)
def test_siblings_exist_and_say_what_differs(page):
    assert page.siblings and page.siblings.keys() <= KNOWN
    assert page.id not in page.siblings
    assert all(why and not why.endswith(".") for why in page.siblings.values())


def test_a_page_is_seen_at_its_own_stage_and_site_where_it_says_nothing_else():
    own, tip, none = (library()[name] for name in ("coulomb_friction", "tool_offset", "axis_skew"))
    assert own.channels("roll") == (Channel("motor_mechanics", "roll"),)
    assert tip.channels("tip") == (Channel("mechanism", "tip"), Channel("structure", "tip"))
    assert none.channels("roll") == ()


def test_the_first_coefficient_exceeds_what_the_page_says():
    resists, free = library()["coulomb_friction"], library()["force_bias"]
    assert [resists.admissible({}, np.array([x])) for x in (-1.0, 0.0, 1.0)] == [False, False, True]
    assert free.admissible({}, np.array([-1.0]))


def test_parameters_are_those_of_the_shape_and_coefficients_in_order():
    drifts, limited = library()["friction_drift"], library()["force_saturation"]
    found = drifts.parameters({"time_constant": 2.0}, np.array([0.5, 0.1]))
    assert found == {"force": 0.5, "drift": 0.1, "time_constant": 2.0}
    assert limited.parameters({"limit": 9.0, "knee": 0.2}, np.zeros(0)) == {"limit": 9.0}


def test_a_computed_parameter_belongs_to_one_effect():
    names = ["delay", "effort_delay", "limit", "probability", "relative", "sigma", "skew"]
    assert sorted(page.computed for page in every().values() if page.computed) == names
    assert [computed(name).id for name in names[:3]] == ["command_delay", "sensor_delay", "force_saturation"]
    assert (
        not computed("effort_delay").at_estimate().shapes([], "axis")
        and computed("limit").at_estimate().id == "force_saturation"
    )


@pytest.mark.parametrize("page", ROBOT_PAGES)
def test_the_page_and_its_form_in_the_plant_are_one(page):
    form = plants()[page.id]
    assert (form.id, form.family, form.stage) == (page.id, page.family, page.stage)
    assert type(page).__module__ == form.__module__ == f"sher3_effects.{page.family}.{page.id}"
    assert set(page.places) <= SITES.keys()
    for name, spec in page.specification.items():
        assert spec.low <= spec.default <= spec.high and spec.text, name


@pytest.mark.parametrize("page", ROBOT_PAGES)
def test_units_turn_with_the_axis(page):
    for name, spec in page.specification.items():
        if name in page.units:
            continue
        assert page.unit(name, "delta_1", False) == spec.unit
        turned = spec.unit if spec.fixed_unit else ROTARY.get(spec.unit, spec.unit)
        assert page.unit(name, "roll", True) == turned


def test_plant_and_engine_turn_units_alike():
    assert {unit: turned for unit, (turned, _) in REVOLUTE.items()} == dict(ROTARY)


@pytest.mark.parametrize("page", ROBOT_PAGES)
def test_the_form_in_the_plant_survives_the_effects_file(page, tmp_path):
    made = [page.plant(site) for site in page.plant.sites]
    save_effects(tmp_path / "effects.yaml", made)
    assert load_effects(tmp_path / "effects.yaml") == made


def test_pages_that_need_more_than_is_known_are_left_out():
    bare = {page.id for page in pages("axis", ())}
    assert {"coulomb_friction", "viscous_friction", "gravity_load"} <= bare
    assert not bare & {"payload_mass", "torque_constant", "cogging", "backlash"}
    assert "backlash" in {page.id for page in pages("axis", {"load"})}
    assert {p.id for p in pages("axis", {"alone", "drive"})} - bare >= {"backlash", "transmission_compliance"}
    assert {p.id for p in pages("servo", {"behind"})} - {p.id for p in pages("servo", ())} == {"backlash"}
    assert {page.id for page in pages("arm")} == {"encoder_offset", "joint_sag", "link_length_error", "rail_tilt"}


def test_the_face_imports_no_page():
    code = "import sys, sher3_effects; print([m for m in sys.modules if m.startswith('sher3_effects.')])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "[]"
