"""Parameters of faults: drawn alike on every plant, in the unit of the actuator they sit on."""

import numpy as np
import pytest
from sher3_challenge.plants.declared import DECLARED
from sher3_challenge.plants.drawn import DRAWN
from sher3_challenge.plants.kinds import Fault
from sher3_challenge.plants.plant import Climate
from sher3_challenge.plants.registry import plant_names, truth_plant
from sher3_challenge.plants.site import ANGULAR, Site
from sher3_description import load_robot


def drawn(kind, actuator, x, seed=0):
    return DRAWN[kind](Site(actuator, np.random.default_rng(seed)), x)


def test_only_declared_kinds_are_drawn():
    assert set(DRAWN) < set(DECLARED)


def test_a_width_on_roll_is_an_angle():
    assert drawn("backlash", "delta_1", 3e-6) == {"width": 3e-6}
    assert drawn("backlash", "roll", 3e-6) == {"width": 3e-6 * ANGULAR["length"]}


def test_a_drive_that_is_weaker_by_half_ends_at_eight_newtons():
    assert drawn("force_saturation", "tilt", 0.5) == {"limit": pytest.approx(8.0)}


def test_a_tool_is_never_off_by_more_than_fifteen_grams_and_a_vector_has_its_length():
    assert abs(drawn("tool_gravity", "force_sensor", 0.1)["mass"]) == 0.015
    assert np.linalg.norm(list(drawn("tool_offset", "tip", 2e-6).values())) == pytest.approx(2e-6)


@pytest.mark.parametrize("kind", ["controller_gain", "encoder_offset", "axis_skew"])
def test_a_law_adds_nothing_to_what_is_drawn_for_a_fault(kind):
    """Of each plant what was drawn comes back as the fault's parameters."""
    for truth in map(truth_plant, plant_names()):
        fault = Fault(truth.library[kind], "roll", 1e-3, seed=0)
        plant = truth.make(load_robot(), 0, (fault,), Climate(22.0, 0.0, 100.0, 10**18))
        assert plant.parameters() == [drawn(kind, "roll", 1e-3)]
