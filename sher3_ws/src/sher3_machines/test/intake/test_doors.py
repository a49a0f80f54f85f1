"""Forms of records that people have: logs of drives, archives, workbooks, JSON lines, Parquet, lists in cells."""

import json
import sys

import numpy as np
import pytest
import scipy.io
from sher3_machines import MachineError
from sher3_machines.intake.tables import read_tables

EPOS = '''Date:;2020-07-08 21:54:05
Firmware Version:;0x0120;0x6150;0x0000;0x0000
Max. samples:;500
Scale:;0;True;100.000;0.500;-400.500;399.500
"Trigger:;0;0.000000;""Parameter values"";""Channel 1"";""Rising above value"""
;Velocity actual value averaged;Torque actual value averaged
ms;rpm;%
0.000;0;-800
40.000;1;0.5
80.000;2;0.7
120.000;3;0.9
'''


def tables(tmp_path, text, name="a.csv"):
    (tmp_path / name).write_text(text, encoding="utf-8")
    return read_tables(tmp_path / name)


def test_the_log_of_a_drive_under_its_settings(tmp_path):
    found = tables(tmp_path, EPOS)
    assert found["time [ms]"].tolist() == [0.0, 40.0, 80.0, 120.0]
    assert found["Torque actual value averaged [%]"].tolist() == [-800.0, 0.5, 0.7, 0.9]


def test_a_log_that_a_spreadsheet_saved_again_with_remarks_behind_its_lines(tmp_path):
    again = "\n".join(line + (",,was -11.1" if ";-800" in line else ",,") for line in EPOS.splitlines())
    assert set(tables(tmp_path, again)) == set(tables(tmp_path, EPOS))
    assert tables(tmp_path, again)["Torque actual value averaged [%]"][0] == -800.0


@pytest.mark.parametrize("cell", ['"[1.0, 2.0]"', "[1.0, 2.0]", "[1. 2.]", '"(1, 2)"', '"{1;2}"'])
def test_a_list_in_a_cell(tmp_path, cell):
    found = tables(tmp_path, f"t,q,r\n0.0,{cell},5\n0.1,{cell},6\n")
    assert found["q"].tolist() == [[1.0, 2.0]] * 2 and found["r"].tolist() == [5.0, 6.0]


def test_an_empty_cell_among_lists_is_a_row_of_nothing(tmp_path):
    found = tables(tmp_path, 't,q\n0.0,"[1, 2]"\n0.1,\n0.2,"[3, 4]"\n')["q"]
    assert found.shape == (3, 2) and np.isnan(found[1]).all() and found[2].tolist() == [3.0, 4.0]


def test_json_lines(tmp_path):
    lines = [{"t": 0.1 * i, "joint": {"q": [i, 2 * i]}, "note": "x"} for i in range(3)]
    del lines[1]["joint"]
    found = tables(tmp_path, "\n".join(map(json.dumps, lines)), "a.jsonl")
    assert found["t"] == pytest.approx([0.0, 0.1, 0.2]) and found["joint/q"][2].tolist() == [2.0, 4.0]
    assert np.isnan(found["joint/q"][1]).all()
    with pytest.raises(MachineError, match="not every line is an object"):
        tables(tmp_path, "1\n2\n", "b.jsonl")


def test_the_answer_of_an_archive(tmp_path):
    """Seconds and nanoseconds are one clock; a value of severity 3 is none."""
    rows = [{"secs": 1600000000, "nanos": 500000000 * i, "val": 2.0 * i, "severity": 3 * (i == 1)} for i in range(3)]
    text = json.dumps([{"meta": {"name": "M1:RBV", "EGU": "mm"}, "data": rows}])
    found = tables(tmp_path, text, "a.json")
    assert np.diff(found["M1:RBV/stamp"]).tolist() == [0.5, 0.5]
    assert found["M1:RBV/value [mm]"][[0, 2]].tolist() == [0.0, 4.0] and np.isnan(found["M1:RBV/value [mm]"][1])


def test_a_clock_in_two_columns_and_dates_with_strokes(tmp_path):
    found = tables(tmp_path, "secs,val,nanos\n10,1.5,250000000\n10,2.5,750000000\n")
    assert found["stamp"].tolist() == [10.25, 10.75]
    found = tables(tmp_path, "Time\tM1:RBV\n2024/03/01 12:00:00.5\t1\n2024/03/01 12:00:00.75\t2\n")
    assert np.diff(found["Time"]) == pytest.approx([0.25])


def test_parquet_with_lists(tmp_path):
    pa, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    table = pa.table({"t": [0.0, 0.1], "q": [[1.0, 2.0], [3.0, 4.0]], "name": ["a", "b"]})
    pq.write_table(table, tmp_path / "a.parquet")
    found = read_tables(tmp_path / "a.parquet")
    assert found["q"].tolist() == [[1.0, 2.0], [3.0, 4.0]] and set(found) == {"t", "q"}


def test_a_workbook(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    titles, header = ["Protocol", None, None], ["t [s]", "q [mm]", "note"]
    for row in (titles, header, [0.0, 1.5, "x"], [0.5, 2.5, None], [1.0, 3.0, "y"]):
        book.active.append(row)
    book.create_sheet("empty")
    book.save(tmp_path / "a.xlsx")
    found = read_tables(tmp_path / "a.xlsx")
    assert found["t [s]"].tolist() == [0.0, 0.5, 1.0] and found["q [mm]"].tolist() == [1.5, 2.5, 3.0]


EXTRAS = [("a.parquet", "pyarrow.parquet", "lerobot"), ("a.xlsx", "openpyxl", "excel")]


@pytest.mark.parametrize(("name", "module", "extra"), EXTRAS)
def test_without_its_reader_a_file_says_what_to_install(tmp_path, monkeypatch, name, module, extra):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MachineError, match=rf"install sher3\[{extra}\], or"):
        tables(tmp_path, "x", name)


def test_a_broken_workbook_is_refused(tmp_path):
    with pytest.raises(MachineError, match=r"a\.xlsx: cannot be read"):
        tables(tmp_path, "no workbook", "a.xlsx")


def test_a_row_for_each_joint_stands_beside_gains_and_matrices_of_other_tables(tmp_path):
    """Six joints, 50 samples, in a struct with its clock; a gain for each joint makes no sample of it."""
    rec = {"time": np.linspace(0.0, 1.0, 50), "q": np.ones((6, 50))}
    scipy.io.savemat(tmp_path / "a.mat", {"rec": rec, "para": {"gain": np.ones(6)}, "tau": np.ones((6, 50))})
    found = read_tables(tmp_path / "a.mat")
    assert found["rec/q"].shape == found["tau"].shape == (50, 6)
