"""What faults are told as: drawn alike on every plant, in the unit of the actuator they sit on."""

import numpy as np
import pytest
from sher3_challenge.plants.declared import DECLARED
from sher3_challenge.plants.registry import plant_names, truth_plant
from sher3_challenge.plants.site import ANGULAR, Site
from sher3_challenge.plants.told import TOLD


def told(kind, actuator, x, seed=0):
    return TOLD[kind](Site(actuator, np.random.default_rng(seed)), x)


def test_only_declared_kinds_are_told():
    assert set(TOLD) < set(DECLARED)


def test_a_width_on_roll_is_an_angle():
    assert told("backlash", "delta_1", 3e-6) == {"width": 3e-6}
    assert told("backlash", "roll", 3e-6) == {"width": 3e-6 * ANGULAR["length"]}


def test_a_drive_that_is_weaker_by_half_ends_at_eight_newtons():
    assert told("force_saturation", "tilt", 0.5) == {"limit": pytest.approx(8.0)}


def test_a_tool_is_never_off_by_more_than_fifteen_grams_and_a_vector_has_its_length():
    assert abs(told("tool_gravity", "force_sensor", 0.1)["mass"]) == 0.015
    assert np.linalg.norm(list(told("tool_offset", "tip", 2e-6).values())) == pytest.approx(2e-6)


@pytest.mark.parametrize("kind", ["controller_gain", "encoder_offset", "axis_skew"])
def test_a_law_adds_nothing_to_what_a_fault_is_told_as(kind):
    """Of each plant the law is called with what was drawn, which comes back as the fault's parameters."""
    names = [truth_plant(name).library[kind].apply.args[0].__annotations__ for name in plant_names()]
    assert all(set(told(kind, "roll", 1e-3)) <= set(found) for found in names)
