"""Data files of every format as named arrays."""

import numpy as np
import pytest
import scipy.io
from sher3_machines import MachineError
from sher3_machines.intake.tables import read_tables


def test_tables_of_every_shape(tmp_path):
    (tmp_path / "a.json").write_text('{"kp": 8, "entries": [{"t": 0.0, "q": 1.5}, {"t": 0.1, "q": 2.5}], "note": "x"}')
    (tmp_path / "b.csv").write_text("t;q\n0.0;1.5\n0.1;2.5\n")
    (tmp_path / "c.txt").write_text("0.0 1.5\n0.1 2.5\n")
    assert read_tables(tmp_path / "a.json")["entries/q"].tolist() == [1.5, 2.5]
    assert read_tables(tmp_path / "b.csv")["q"].tolist() == [1.5, 2.5]
    assert read_tables(tmp_path / "c.txt")["c1"].tolist() == [1.5, 2.5]
    (tmp_path / "d.xls").write_text("")
    with pytest.raises(MachineError, match="format is not read"):
        read_tables(tmp_path / "d.xls")


def test_lists_in_cells_are_rows_of_a_matrix(tmp_path):
    (tmp_path / "a.csv").write_text('t,q\n0.0,"[1.0, 2.0]"\n0.1,"[3.0, 4.0]"\n')
    assert read_tables(tmp_path / "a.csv")["q"].tolist() == [[1.0, 2.0], [3.0, 4.0]]


def test_text_is_left_out_and_empty_cells_are_not_a_number(tmp_path):
    (tmp_path / "a.csv").write_text("t,name,q\n0.0,x,1.0\n0.1,y,\n")
    found = read_tables(tmp_path / "a.csv")
    assert set(found) == {"t", "q"} and np.isnan(found["q"][1])


def test_a_folder_is_its_files(tmp_path):
    np.savez(tmp_path / "a.npz", q=np.arange(3))
    scipy.io.savemat(tmp_path / "b.mat", {"r": np.arange(3.0)})
    (tmp_path / "notes.txt").write_text("no data\n")
    assert {k: v.shape for k, v in read_tables(tmp_path).items()} == {"a/q": (3,), "b/r": (3,)}


@pytest.mark.parametrize("name", ["gone.csv", "empty"])
def test_what_is_not_there_is_named(tmp_path, name):
    (tmp_path / "empty").mkdir()
    with pytest.raises(MachineError, match=r"no such file|no data files"):
        read_tables(tmp_path / name)


def test_a_row_for_each_joint_is_turned_to_a_row_for_each_sample(tmp_path):
    time, q = np.linspace(0.0, 1.0, 50), np.arange(150.0).reshape(3, 50)
    scipy.io.savemat(tmp_path / "a.mat", {"t": time, "q": q, "frames": np.ones((50, 4)), "gains": np.eye(2)})
    found = read_tables(tmp_path / "a.mat")
    assert found["q"].shape == (50, 3) and found["q"][1].tolist() == [1.0, 51.0, 101.0]
    assert found["frames"].shape == (50, 4) and found["gains"].shape == (2, 2)


def test_texts_are_read_in_a_folder_that_holds_no_other_data(tmp_path):
    np.savetxt(tmp_path / "q.txt", np.zeros((30, 2)))
    (tmp_path / "readme.txt").write_text("how it was measured\n")
    assert set(read_tables(tmp_path)) == {"q/c0", "q/c1"}


@pytest.mark.parametrize(("shape", "read"), [((3, 1140), (1140, 3)), ((1140, 3), (1140, 3)), ((30, 40), (30, 40))])
def test_a_matrix_by_itself_that_is_much_wider_than_long_has_a_row_for_each_signal(tmp_path, shape, read):
    np.savez(tmp_path / "a.npz", data=np.arange(shape[0] * shape[1], dtype=float).reshape(shape))
    assert read_tables(tmp_path / "a.npz")["data"].shape == read


def test_what_is_one_sample_longer_is_as_long_as_the_clock(tmp_path):
    t = np.arange(50.0)
    np.savez(tmp_path / "a.npz", t=t, u=np.arange(51.0), gain=np.ones(3))
    found = read_tables(tmp_path / "a.npz")
    assert {name: len(x) for name, x in found.items()} == {"t": 50, "u": 50, "gain": 3} and found["u"][-1] == 49.0
