"""Discovered effects as pages: read, refused, fitted again, and in the plant."""

from types import SimpleNamespace

import numpy as np
import pytest
from sher3_common import FileError
from sher3_description import load_robot
from sher3_effects import add_library, library, load_effects, plants, save_effects
from sher3_effects.found_page import read_found
from sher3_effects.registry import VARIABLE
from sher3_sim import EffectError, with_effects
from sher3_sim.found import ACTS

PAGE = """
schema: sher3.found/1
effect: found_drag
stage: motor_mechanics
sites: [delta_1]
explanation: an extra force on delta 1 in proportion to the square of the velocity
terms:
- {component: 0, feature: signed_square(velocity), coefficient: 2.0e4, unit: N/(m/s)^2}
- {component: 0, feature: "sine(position, 0.0015)", coefficient: 0.5, unit: N}
- {component: 0, feature: "cosine(position, 0.0015)", coefficient: 0.1, unit: N}
"""


@pytest.fixture
def page(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    (tmp_path / "drag.yaml").write_text(PAGE)
    add_library([tmp_path / "drag.yaml"])
    return tmp_path / "drag.yaml"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("component: 0", "component: x"),
        ("component: 0", "component: .inf"),
        ("sites: [delta_1]", "sites: []"),
        ("sites: [delta_1]", "sites: 3"),
        ("coefficient: 2.0e4", "coefficient: much"),
        ("coefficient: 2.0e4", "coefficient: [1]"),
        ("terms:\n- {", "terms:\n- []\n- {"),
    ],
)
def test_what_is_wrong_inside_is_a_typed_error(tmp_path, before, after):
    path = tmp_path / "wrong.yaml"
    path.write_text(PAGE.replace(before, after, 1))
    with pytest.raises(FileError, match="is not a discovered effect"):
        read_found(path)


def test_a_file_is_a_page_with_units_and_shapes(page):
    found = library()["found_drag"]
    assert found.shape == {"period_1": 0.0015} and found.unit("period_1", "delta_1", False) == "m"
    assert found.unit("coefficient_1", "delta_1", False) == "N/(m/s)^2"
    assert found.channels("delta_2") == () and len(found.channels("delta_1")) == 1
    assert found.inputs == ("velocity", "position")
    assert found.leaves_out  # a formula of few terms is no complete law
    moved = found.reshaped(found.terms[1].feature, {"period_1": 0.002})
    assert str(moved) == "sine(position, 0.002)"


def test_of_two_encoders_it_has_their_zeros_beside_its_terms(page):
    """What runs change tells no zero: one column of ones more, and no parameter for it."""
    found = library()["found_drag"]
    between = type("Between", (type(found),), {"stage": "transmission"})()
    run = SimpleNamespace(ticks=3)
    quantities = dict.fromkeys(("velocity", "position"), SimpleNamespace(values=np.array([1.0, 2.0, 3.0])))
    view = SimpleNamespace(run=run, step=1, recorded=lambda main: quantities, at_residuals=lambda x: x)
    for law, more in ((found, 0), (between, 1)):
        (columns,) = law.signature(view, "delta_1", found.shape).columns.values()
        assert columns.shape == (3, 1, len(found.terms) + more)
        stated = law.parameters({}, np.arange(1.0, 1.0 + columns.shape[2]))
        assert stated == {f"coefficient_{k + 1}": k + 1.0 for k in range(len(found.terms))}
    assert (columns[:, 0, -1] == 1.0).all()


def test_its_form_in_the_plant_goes_through_an_effects_file(page, monkeypatch):
    effect = plants()["found_drag"]("delta_1", coefficient_1=1e4)
    assert effect.parameters == {"coefficient_1": 1e4, "coefficient_2": 0.5, "coefficient_3": 0.1, "period_1": 0.0015}
    save_effects(page.parent / "effects.yaml", [effect])
    monkeypatch.setenv(VARIABLE, "")
    assert "found_drag" not in library()
    assert [e.parameters for e in load_effects(page.parent / "effects.yaml")] == [effect.parameters]
    rows = with_effects(load_robot(), [effect]).axis["found"][0]
    assert (rows[:, 0] != 0).sum() == 3 and rows[0, 2] == 1e4


def test_it_sits_where_it_was_found(page):
    with pytest.raises(EffectError, match="cannot sit"):
        plants()["found_drag"]("delta_2")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("sher3.found/1", "sher3.effects/1"),
        ("motor_mechanics", "moon"),
        ("delta_1]", "delta_1, moon]"),
        ("signed_square", "cube"),
        ("2.0e4", ".nan"),
        ("component: 0, feature: signed", "component: 3, feature: signed"),
        ("terms:", "words:"),
    ],
)
def test_a_file_that_is_no_page_is_refused(tmp_path, old, new):
    (tmp_path / "wrong.yaml").write_text(PAGE.replace(old, new, 1))
    with pytest.raises(FileError, match="is not a discovered effect"):
        read_found(tmp_path / "wrong.yaml")


@pytest.mark.parametrize("stage", ["controller", "transport"])
def test_a_formula_of_what_passes_commands_on_has_its_place_in_the_plant(stage, tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    (tmp_path / "late.yaml").write_text(PAGE.replace("motor_mechanics", stage))
    rows = with_effects(load_robot(), [read_found(tmp_path / "late.yaml").plant("delta_1")]).axis["found"][0]
    assert set(rows[rows[:, 0] != 0, 0]) == {ACTS[stage]}


def test_a_quantity_that_the_plant_does_not_have_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    (tmp_path / "late.yaml").write_text(PAGE.replace("signed_square(velocity)", "itself(mood)"))
    effect = read_found(tmp_path / "late.yaml").plant("delta_1")
    with pytest.raises(EffectError, match="no such quantity"):
        with_effects(load_robot(), [effect])
