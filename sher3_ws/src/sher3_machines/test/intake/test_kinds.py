"""Kinds of machine: found by their folder or entry point, and each with all an importer needs."""

import sys
from importlib.metadata import EntryPoint

import pytest
from sher3_machines import MachineError, kinds, load_description
from sher3_machines.intake.kinds import GROUP, kinds_of_others


def test_every_folder_with_a_kind_is_one():
    assert set(kinds()) == {"arm", "axes", "force_sensor", "load_cell", "manipulator", "positioning"}
    assert all(kind.name == name for name, kind in kinds().items())


def test_an_unknown_kind_is_named(tmp_path):
    (tmp_path / "machine.yaml").write_text("kind: delta\nname: x\n")
    with pytest.raises(MachineError, match="no such kind") as caught:
        load_description(tmp_path / "machine.yaml")
    assert caught.value.value == "'delta'"
    assert set(caught.value.limit.split(", ")) == set(kinds())


@pytest.mark.parametrize("text", ["name: x\n", "kind: [axes]\n"])
def test_a_file_that_describes_nothing_is_refused(tmp_path, text):
    (tmp_path / "machine.yaml").write_text(text)
    with pytest.raises(MachineError, match="no such kind"):
        load_description(tmp_path / "machine.yaml")


def test_a_new_folder_is_a_new_kind(tmp_path):
    """A package in a folder of its own, beside a copy of nothing else: its kind is found, read and opened."""
    import sher3_machines
    from sher3_machines.intake.kinds import kinds_in

    folder = tmp_path / "table"
    folder.mkdir()
    (folder / "__init__.py").write_text('"""A turning table."""\n')
    (folder / "kind.py").write_text(
        "from sher3_machines.axes.kind import AxesKind\n\n\n"
        "class Table(AxesKind):\n    name = 'table'\n\n\nKIND = Table()\n"
    )
    sher3_machines.__path__.append(str(tmp_path))
    try:
        assert set(kinds_in(tmp_path)) == {"table"}
    finally:
        sher3_machines.__path__.remove(str(tmp_path))


def given(monkeypatch, tmp_path, text):
    """A package of somebody else's with one entry point."""
    (tmp_path / "scales_of_ours.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    points = [EntryPoint("scale", "scales_of_ours:KIND", GROUP)]
    monkeypatch.setattr("sher3_machines.intake.kinds.entry_points", lambda group: points if group == GROUP else [])
    monkeypatch.delitem(sys.modules, "scales_of_ours", raising=False)


SCALE = "from sher3_static.cell.kind import CellKind\n\n\nclass Scale(CellKind):\n    name = {name!r}\n\n\n"


def test_another_package_gives_a_kind_by_its_entry_point(monkeypatch, tmp_path):
    given(monkeypatch, tmp_path, SCALE.format(name="scale") + "KIND = Scale()\n")
    assert set(kinds_of_others()) == {"scale"}


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
        kinds_of_others()
