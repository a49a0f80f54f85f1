"""Kinds of machine: found by their entry point, and each with all an importer needs."""

import sys
from importlib.metadata import EntryPoint, entry_points

import pytest
from sher3_machines import MachineError, kinds, load_description
from sher3_machines.intake.kinds import GROUP, found_kinds


def test_the_kinds_of_this_project():
    assert set(kinds()) == {"arm", "axes", "force_sensor", "load_cell", "manipulator", "positioning"}
    assert all(kind.name == name for name, kind in kinds().items())


def test_an_unknown_kind_is_named(tmp_path):
    (tmp_path / "machine.yaml").write_text("kind: delta\nname: x\n")
    with pytest.raises(MachineError, match="no such kind") as caught:
        load_description(tmp_path / "machine.yaml")
    assert caught.value.value == "'delta'"
    assert set(caught.value.limit.split(", ")) == set(kinds())


def test_a_field_that_is_missing_is_drafted_by_a_command(tmp_path):
    """Ten lines by hand without the count of an encoder, which few people know."""
    axis = "axes: [{name: a, motion: rotary, signals: {position: {column: q, unit: rad}}, command_law: {kind: none}}]"
    (tmp_path / "m.yaml").write_text(f"kind: axes\nname: m\ntime: {{rate: 100}}\n{axis}\n", encoding="utf-8")
    with pytest.raises(MachineError, match=r"encoder_resolution: Field required.*sher3 gap describe"):
        load_description(tmp_path / "m.yaml")


@pytest.mark.parametrize("text", ["name: x\n", "kind: [axes]\n"])
def test_a_file_that_describes_nothing_is_refused(tmp_path, text):
    (tmp_path / "machine.yaml").write_text(text)
    with pytest.raises(MachineError, match="no such kind"):
        load_description(tmp_path / "machine.yaml")


def given(monkeypatch, tmp_path, text):
    """A package of somebody else's with one entry point beside those of this project."""
    (tmp_path / "scales_of_ours.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    points = [*entry_points(group=GROUP), EntryPoint("scale", "scales_of_ours:KIND", GROUP)]
    monkeypatch.setattr("sher3_machines.intake.kinds.entry_points", lambda group: points if group == GROUP else [])
    monkeypatch.delitem(sys.modules, "scales_of_ours", raising=False)


SCALE = "from sher3_static.cell.kind import CellKind\n\n\nclass Scale(CellKind):\n    name = {name!r}\n\n\n"


def test_another_package_gives_a_kind_by_its_entry_point(monkeypatch, tmp_path):
    given(monkeypatch, tmp_path, SCALE.format(name="scale") + "KIND = Scale()\n")
    assert found_kinds()["scale"].name == "scale"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (SCALE.format(name="axes") + "KIND = Scale()\n", "name is taken; value axes"),
        (SCALE.format(name="scale") + "KIND = Scale\n", "is no kind"),
        ("import nothing_of_that_name\n", "cannot be loaded"),
    ],
)
def test_an_entry_point_that_gives_no_kind_is_refused(monkeypatch, tmp_path, text, words):
    given(monkeypatch, tmp_path, text)
    with pytest.raises(MachineError, match=words):
        found_kinds()
