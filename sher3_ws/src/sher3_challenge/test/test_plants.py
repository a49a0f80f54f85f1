"""The registry of truth plants: found by folder, every one complete, and what is missing is named."""

import pytest
from sher3_challenge.errors import ChallengeError
from sher3_challenge.plants import registry
from sher3_challenge.plants.grammar import CATALOGUE
from sher3_challenge.plants.registry import plant_names, truth_plant
from sher3_challenge.warm import warm_up

REQUIRED = {"lead_error", "force_bias", "force_drift", "torque_constant", "gravity_load", "thermal_expansion"}
"""Kinds of which under-excited cases are made."""


@pytest.mark.parametrize("name", plant_names())
def test_every_plant_stands_for_the_whole_catalogue_and_for_kinds_outside_it(name):
    plant = truth_plant(name)
    assert plant.name == name and len(plant.effects) == 44 and set(plant.library) >= REQUIRED
    assert len(plant.outside) >= 12 and all(kind.effect == "outside_library" for kind in plant.outside.values())
    assert not set(plant.library) & set(plant.outside)


def test_the_set_up_runs_every_plant():
    assert set(warm_up()) == set(plant_names())


def test_no_two_plants_share_a_kind_outside_the_catalogue():
    """But for those of the grammar, which has no plant's laws: each case of one draws a law of its own."""
    names = [name for plant in plant_names() for name in truth_plant(plant).outside if name not in CATALOGUE]
    assert len(set(names)) == len(names) >= 3 * 12


def test_a_plant_that_lacks_its_library_says_so(monkeypatch):
    def no_such(name):
        raise ModuleNotFoundError("No module named 'hydra'", name="hydra")

    monkeypatch.setattr(registry.importlib, "import_module", no_such)
    with pytest.raises(ChallengeError, match=r"lumped: hydra.*--plant"):
        truth_plant("lumped")
