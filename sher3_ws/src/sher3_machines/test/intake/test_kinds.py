"""Kinds of machine: found by their folder, and each with all an importer needs."""

import pytest
from sher3_machines import MachineError, kinds, load_description


def test_every_folder_with_a_kind_is_one():
    assert set(kinds()) == {"arm", "axes", "force_sensor", "load_cell", "manipulator", "positioning"}
    assert all(kind.name == name for name, kind in kinds().items())


def test_an_unknown_kind_is_named(tmp_path):
    (tmp_path / "machine.yaml").write_text("kind: delta\nname: x\n")
    with pytest.raises(MachineError, match="no such kind") as caught:
        load_description(tmp_path / "machine.yaml")
    assert caught.value.value == "'delta'"
    assert caught.value.limit == "arm, axes, load_cell, manipulator, positioning, force_sensor"


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
