"""Packed files, arrays of NumPy, and endings that are known and not read."""

import gzip
import os
import pickle
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from sher3_machines import MachineError
from sher3_machines.intake import tables as intake
from sher3_machines.intake.runs import runs_of
from sher3_machines.intake.tables import read_tables

T = np.arange(30) / 100.0
CSV = "t,q\n" + "\n".join(f"{t},{2 * t}" for t in T) + "\n"


def test_a_gzipped_table_is_read_as_the_table(tmp_path):
    (tmp_path / "a.csv.gz").write_bytes(gzip.compress(CSV.encode()))
    assert read_tables(tmp_path / "a.csv.gz")["q"].tolist() == (2 * T).tolist()


@pytest.mark.parametrize("above", ["", "logs/"])
def test_an_archive_is_read_as_its_folder(tmp_path, above):
    with zipfile.ZipFile(tmp_path / "a.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(f"{above}joint.csv", CSV)
        archive.writestr(f"{above}scale.csv", CSV)
        archive.writestr(f"__MACOSX/{above}._joint.csv", "x")
    assert set(read_tables(tmp_path / "a.zip")) == {"joint/t", "joint/q", "scale/t", "scale/q"}


def test_an_archive_of_one_table_is_the_table_and_one_of_trials_is_runs(tmp_path):
    for name, files in (("one", ["a.csv"]), ("many", ["trial_1.csv", "trial_2.csv"])):
        with zipfile.ZipFile(tmp_path / f"{name}.zip", "w") as archive:
            for file in files:
                archive.writestr(file, CSV)
    assert set(read_tables(tmp_path / "one.zip")) == {"t", "q"}
    assert {name: set(x) for name, x in runs_of([tmp_path / "many.zip"]).items()} == {
        "trial_1": {"t", "q"},
        "trial_2": {"t", "q"},
    }


def test_no_member_leaves_the_folder(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("../../outside.csv", CSV)
    assert "q" in read_tables(tmp_path / "a.zip")
    assert not list(tmp_path.rglob("outside.csv")) and not list(tmp_path.parent.glob("outside.csv"))


@pytest.mark.parametrize("name", ["a.csv.gz", "a.zip"])
@pytest.mark.parametrize("spoil", [lambda x: x[: len(x) // 2], lambda x: b"no archive", lambda x: b""])
def test_damaged_ones_are_refused(tmp_path, name, spoil):
    path = tmp_path / name
    if name.endswith("gz"):
        path.write_bytes(spoil(gzip.compress(os.urandom(2000))))
    else:
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("a.csv", CSV)
        path.write_bytes(spoil(path.read_bytes()))
    with pytest.raises(MachineError, match=rf"{name}: .*(unpacked|cannot be read)"):
        read_tables(path)


@pytest.mark.parametrize("name", ["a.csv.gz", "a.zip"])
def test_bombs_are_refused(tmp_path, monkeypatch, name):
    monkeypatch.setattr(intake, "MAX_BYTES", 1_000_000)
    if name.endswith("gz"):
        (tmp_path / name).write_bytes(gzip.compress(bytes(5_000_000)))
    else:
        with zipfile.ZipFile(tmp_path / name, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("a.csv", bytes(5_000_000))
    with pytest.raises(MachineError, match="unpacks to too much"):
        read_tables(tmp_path / name)


def test_what_is_wrong_within_is_said_of_the_packed_file(tmp_path):
    (tmp_path / "a.xyz.gz").write_bytes(gzip.compress(b"\x00" * 100))
    with pytest.raises(MachineError, match=r"a\.xyz\.gz: a\.xyz: format is not read") as caught:
        read_tables(tmp_path / "a.xyz.gz")
    assert str(caught.value).count("a.xyz") == 2, "no temporary path"


def test_arrays_of_numpy_are_tables(tmp_path):
    np.save(tmp_path / "table.npy", np.column_stack([T, 2 * T]))
    np.save(tmp_path / "list.npy", T)
    np.save(tmp_path / "poses.npy", np.zeros((30, 4, 4)))
    np.save(tmp_path / "record.npy", np.array([(t, 1) for t in T], [("t", "f8"), ("n", "i4")]))
    shapes = {
        name: {k: x.shape for k, x in read_tables(tmp_path / f"{name}.npy").items()}
        for name in ("table", "list", "poses", "record")
    }
    assert shapes == {
        "table": {"c0": (30,), "c1": (30,)},
        "list": {"array": (30,)},
        "poses": {"array": (30, 4, 4)},
        "record": {"t": (30,), "n": (30,)},
    }


@pytest.mark.parametrize("cut", [0, 50, 200])
def test_a_cut_array_is_refused(tmp_path, cut):
    np.save(tmp_path / "a.npy", T)
    (tmp_path / "a.npy").write_bytes((tmp_path / "a.npy").read_bytes()[:cut])
    with pytest.raises(MachineError, match=r"a\.npy"):
        read_tables(tmp_path / "a.npy")


def test_a_pickle_is_not_opened_and_its_conversion_runs(tmp_path):
    class Trap:
        def __reduce__(self):
            return os.mkdir, (str(tmp_path / "sprung"),)

    (tmp_path / "a.pkl").write_bytes(pickle.dumps(Trap()))
    with pytest.raises(MachineError, match="it may run code") as caught:
        read_tables(tmp_path / "a.pkl")
    assert not (tmp_path / "sprung").exists()
    code = str(caught.value).split('python -c "')[1].rstrip('"')
    (tmp_path / "a.pkl").write_bytes(pickle.dumps({"t": T, "q": T}))
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, timeout=60)
    assert set(read_tables(tmp_path / "a.npz")) == {"t", "q"}
