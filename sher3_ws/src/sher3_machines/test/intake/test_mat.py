"""MATLAB files: structs, class objects, and files that would take their reader down."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from sher3_machines import MachineError
from sher3_machines.drafting.draft import drafted
from sher3_machines.intake.readers import mat, native
from sher3_machines.intake.tables import read_tables


def test_structs_are_paths(tmp_path):
    run = {"t": np.arange(3.0), "q": {"motor": np.ones((3, 1)), "note": "text"}, "n": 7.0}
    scipy.io.savemat(tmp_path / "a.mat", {"run": run, "top": np.eye(3)})
    found = read_tables(tmp_path / "a.mat")
    assert {name: x.shape for name, x in found.items()} == {
        "run/t": (3,),
        "run/q/motor": (3,),
        "run/n": (1,),
        "top": (3, 3),
    }


def test_rows_of_a_struct_array_are_stacked(tmp_path):
    rows = np.array([(1.0, np.arange(2.0)), (2.0, np.arange(2.0))], dtype=[("t", object), ("q", object)])
    scipy.io.savemat(tmp_path / "a.mat", {"rows": rows})
    found = read_tables(tmp_path / "a.mat")
    assert found["rows/t"].ravel().tolist() == [1.0, 2.0] and found["rows/q"].shape == (2, 2)


def test_a_file_without_an_array_says_what_only_matlab_opens(tmp_path):
    """As of a table, which is an object."""
    scipy.io.savemat(tmp_path / "a.mat", {"note": "text"})
    with pytest.raises(MachineError, match="writetable"):
        read_tables(tmp_path / "a.mat")


def test_a_class_object_is_a_column_without_rows_that_the_draft_names():
    opaque = np.zeros((1,), dtype=[("_TypeSystem", object), (mat.CLASS, object), ("_ObjectMetadata", object)])
    found = mat.flatten("", np.array([(np.arange(3.0), opaque)], dtype=[("t", object), ("ans", object)]))
    assert {name: len(x) for name, x in found.items()} == {"t": 3, "ans": 0}
    t = np.arange(0.0, 5.0, 0.01)
    guesses: list[str] = []
    drafted(Path("a.mat"), {"t": t, "q": np.sin(3.0 * t), "ans": np.zeros(0)}, None, guesses)
    assert any("no array in 'ans'" in guess for guess in guesses)


def test_cells_are_numbered(tmp_path):
    cells = np.empty((1, 3), dtype=object)
    cells[0, :] = [np.ones((4, 2)), np.ones((5, 2)), "text"]
    scipy.io.savemat(tmp_path / "a.mat", {"joints": cells})
    found = read_tables(tmp_path / "a.mat")
    assert {name: x.shape for name, x in found.items()} == {"joints/1": (4, 2), "joints/2": (5, 2)}


@pytest.mark.parametrize(
    "text", [b"", b"MATLAB 7.3 MAT-file, Platform", b"MATLAB 5.0 MAT-file" + bytes(200), bytes(500)]
)
def test_what_is_no_mat_file_is_refused(tmp_path, text):
    (tmp_path / "a.mat").write_bytes(text)
    with pytest.raises(MachineError, match=r"a\.mat"):
        read_tables(tmp_path / "a.mat")


@pytest.mark.parametrize("code", [-11, -9, -6])
def test_a_reader_that_crashes_takes_nobody_with_it(tmp_path, monkeypatch, code):
    """Segmentation fault, killed for its memory, aborted: the child ends, and a sentence says so."""
    scipy.io.savemat(tmp_path / "a.mat", {"q": np.arange(3.0)})
    monkeypatch.setattr(subprocess, "run", lambda command, **_: subprocess.CompletedProcess(command, code, b"", b""))
    with pytest.raises(MachineError, match=f"crashed .{code}"):
        read_tables(tmp_path / "a.mat")


def test_a_reader_that_hangs_is_ended(tmp_path, monkeypatch):
    scipy.io.savemat(tmp_path / "a.mat", {"q": np.arange(3.0)})
    monkeypatch.setattr(native, "MAX_SECONDS", 0.01)
    with pytest.raises(MachineError, match=r"more than 0\.01 s"):
        read_tables(tmp_path / "a.mat")


def test_a_file_that_claims_more_memory_than_allowed_is_refused(tmp_path):
    """A compressed file of zeros unpacks to 6 GB."""
    import struct
    import zlib

    rows = 800_000_000
    flags = struct.pack("<IIII", 6, 8, 6, 0)
    dims = struct.pack("<IIii", 5, 8, rows, 1)
    name = struct.pack("<HH4s", 1, 1, b"q")
    body = flags + dims + name + struct.pack("<II", 9, 0xFFFFFFF8)
    packed = zlib.compress(struct.pack("<II", 14, 0xFFFFFFF0) + body)
    (tmp_path / "a.mat").write_bytes(
        b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + struct.pack("<II", 15, len(packed)) + packed
    )
    with pytest.raises(MachineError):
        read_tables(tmp_path / "a.mat")


def test_what_hides_in_cells_and_structs_is_counted_before_it_is_unpacked(tmp_path, monkeypatch):
    """Four megabytes of zeros in a cell of a struct take six kilobytes in the file."""
    cell = np.empty(2, dtype=object)
    cell[:] = [np.zeros(250_000), np.zeros(250_000)]
    scipy.io.savemat(tmp_path / "a.mat", {"run": {"deep": cell}}, do_compression=True)
    raw = (tmp_path / "a.mat").read_bytes()
    assert len(raw) < 10_000 and 4_000_000 < mat.unpacked_size(raw, 5_000_000) < 4_001_000
    assert mat.unpacked_size(raw, 1_000_000) < 3_100_000, "counting ends a step beyond the limit"
    monkeypatch.setattr(native, "MAX_BYTES", 1_000_000)
    with pytest.raises(MachineError, match="unpacks to too much"):
        read_tables(tmp_path / "a.mat")


@pytest.mark.parametrize(("title", "numbers"), [("Name", "Data"), ("label", "values")])
def test_signals_in_structs_go_by_the_names_that_stand_in_them(tmp_path, title, numbers):
    """A capture of dSPACE and a structure with time of Simulink keep a signal and its name side by side."""
    path = tmp_path / "capture.mat"
    t = np.arange(50) / 100.0
    rows = np.zeros(2, dtype=[(title, object), (numbers, object), ("Type", object)])
    rows[0], rows[1] = ('"Model Root"/"position"', np.sin(t), 2), ("duty", np.cos(t), 2)
    scipy.io.savemat(path, {"run": {"X": {"Data": t}, "Y": rows}})
    found = read_tables(path)
    assert set(found) == {"run/X/Data", "run/Y/Model Root/position", "run/Y/duty"}
    assert found["run/Y/Model Root/position"] == pytest.approx(np.sin(t))


def test_signals_of_a_structure_with_time_stand_beside_their_stamps(tmp_path):
    """One of them need not be named: it has its number."""
    t = np.arange(50) / 100.0
    rows = np.zeros(2, dtype=[("values", object), ("label", object)])
    rows[0], rows[1] = (np.cos(t), ""), (np.sin(t), "PendPos")
    scipy.io.savemat(tmp_path / "run.mat", {"swing": {"time": t, "signals": rows, "blockName": "rig/Scope"}})
    assert set(read_tables(tmp_path / "run.mat")) == {"swing/time", "swing/1", "swing/PendPos"}
