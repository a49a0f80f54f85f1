"""HDF5 files: datasets by path, those of MATLAB's version 7.3, and files that would take their reader down."""

import numpy as np
import pytest
from sher3_machines import MachineError
from sher3_machines.intake.readers.hdf5 import MAGIC
from sher3_machines.intake.runs import runs_of
from sher3_machines.intake.tables import read_tables

h5py = pytest.importorskip("h5py")
T = np.arange(30) / 100.0


def matlab(group, name, x, kind="double"):
    """A dataset as MATLAB writes it: by columns, with its class."""
    dataset = group.create_dataset(name, data=np.atleast_2d(x).T if np.ndim(x) < 3 else x)
    dataset.attrs["MATLAB_class"] = np.bytes_(kind)
    return dataset


@pytest.mark.parametrize("name", ["a.h5", "a.hdf5", "a.H5"])
@pytest.mark.parametrize("packed", [{}, {"compression": "gzip", "chunks": True}])
def test_datasets_are_columns_by_path(tmp_path, name, packed):
    with h5py.File(tmp_path / name, "w") as file:
        file.create_dataset("log/time", data=T, **packed)
        file.create_dataset("log/q", data=np.ones((30, 6), np.float32), **packed)
        file["log/state"] = np.zeros(30, [("tau", "f8"), ("mode", "i4"), ("note", "S4")])
        file["log/note"] = ["text"] * 30
        file["camera"] = np.zeros((30, 4, 4, 3), np.uint8)
        file["poses"] = np.zeros((30, 4, 4))
        file["log/again"] = h5py.SoftLink("/log/time")
        file["elsewhere"] = h5py.ExternalLink("b.h5", "/x")
        file["rate"] = 100.0
    found = read_tables(tmp_path / name)
    shapes = {"log/time": (30,), "log/q": (30, 6), "log/state/tau": (30,), "log/state/mode": (30,), "poses": (30, 4, 4)}
    assert {key: x.shape for key, x in found.items()} == shapes
    assert found["log/time"].tolist() == T.tolist()


def test_structs_of_matlab_lie_as_matlab_shows_them(tmp_path):
    """`run.t` (30, 1), `run.q` (30, 2), a struct array of two parts, a text, a table and an empty matrix."""
    with h5py.File(tmp_path / "a.mat", "w", userblock_size=512) as file:
        run, hidden = file.create_group("run"), file.create_group("#refs#")
        run.attrs["MATLAB_class"] = np.bytes_("struct")
        matlab(run, "t", T[:, None])
        matlab(run, "q", np.column_stack([T, -T]))
        matlab(run, "name", np.frombuffer(b"slide", np.uint8).astype(np.uint16), "char")
        matlab(file, "table", np.zeros((1, 6)), "table")
        matlab(file, "empty", np.array([[0.0, 0.0]])).attrs["MATLAB_empty"] = 1
        parts = [matlab(hidden, name, x[:, None]).ref for name, x in (("a", T), ("b", T + 0.3))]
        file.create_group("parts").create_dataset("t", data=np.array([parts], dtype=h5py.ref_dtype))
    raw = (tmp_path / "a.mat").read_bytes()
    (tmp_path / "a.mat").write_bytes(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512) + raw[512:])
    found = read_tables(tmp_path / "a.mat")
    assert {name: x.shape for name, x in found.items()} == {"run/t": (30,), "run/q": (30, 2), "parts/t": (30, 2)}
    assert found["run/q"][:, 1].tolist() == (-T).tolist() and found["parts/t"][:, 1].tolist() == (T + 0.3).tolist()


def test_numbered_demonstrations_are_runs_and_joints_are_not(tmp_path):
    with h5py.File(tmp_path / "demos.hdf5", "w") as file:
        for i, n in enumerate((30, 20, 30)):
            file[f"data/demo_{i}/obs/joint1/q"], file[f"data/demo_{i}/obs/joint2/q"] = T[:n], -T[:n]
        file["weights"] = np.ones(3)
    runs = runs_of([tmp_path / "demos.hdf5"])
    assert list(runs) == ["data_demo_0", "data_demo_1", "data_demo_2"]
    assert {name: x.shape for name, x in runs["data_demo_1"].items()} == {
        "weights": (3,),
        "obs/joint1/q": (20,),
        "obs/joint2/q": (20,),
    }


@pytest.mark.parametrize("groups", [["demo_0"], ["run1", "run2"], ["joint1", "joint2"]])
def test_groups_of_other_forms_stay_one_run(tmp_path, groups):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for i, group in enumerate(groups):
            file[f"{group}/q{i if group.startswith('run') else ''}"] = T
    assert list(runs_of([tmp_path / "a.h5"])) == ["a"]


@pytest.mark.parametrize("raw", [MAGIC + bytes(100), b"", bytes(500), b"MATLAB 7.3 MAT-file".ljust(512) + MAGIC])
@pytest.mark.parametrize("name", ["a.h5", "a.mat"])
def test_a_damaged_file_is_refused(tmp_path, raw, name):
    (tmp_path / name).write_bytes(raw)
    with pytest.raises(MachineError, match=rf"{name}: cannot be read"):
        read_tables(tmp_path / name)


def test_a_file_that_unpacks_to_too_much_is_refused(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("q", shape=(1_000_000_000,), dtype="f8", compression="gzip", chunks=True)
    assert (tmp_path / "a.h5").stat().st_size < 10_000
    with pytest.raises(MachineError, match="unpacks to too much"):
        read_tables(tmp_path / "a.h5")


@pytest.mark.parametrize("name", ["a.h5", "a.mat"])
def test_without_a_reader_it_says_what_to_install(tmp_path, monkeypatch, name):
    (tmp_path / name).write_bytes(b"MATLAB 7.3 MAT-file".ljust(512) + MAGIC)
    monkeypatch.setattr("sher3_machines.intake.readers.hdf5.find_spec", lambda _: None)
    with pytest.raises(MachineError, match=r"h5py is not installed.*install sher3\[hdf5\].*-v7"):
        read_tables(tmp_path / name)
