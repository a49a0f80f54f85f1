"""Workbooks: sheets of one machine are runs, as files of a folder are, and titles stand above what changes."""

import numpy as np
import pytest
from sher3_machines.intake.runs import runs_of
from sher3_machines.intake.tables import read_tables

openpyxl = pytest.importorskip("openpyxl")


def saved(path, sheets):
    """Save a workbook of sheets: title -> rows of cells."""
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def rows_of(header, *columns):
    return [header, *np.column_stack(columns).tolist()]


@pytest.mark.parametrize("seconds", [(4.0, 6.0, 3.0), (5.0, 9.0)])
def test_sheets_with_the_same_titles_are_runs(tmp_path, seconds):
    header = ["Time (ms)", "Position Actual (deg)", "Current (A)"]
    times = [1e3 * np.arange(0.0, end, 0.01) for end in seconds]
    sheets = {f"square, {i} Hz": rows_of(header, t, np.sin(t), np.cos(t)) for i, t in enumerate(times)}
    runs = runs_of([saved(tmp_path / "a.xlsx", sheets)])
    assert list(runs) == list(sheets) and [set(run) for run in runs.values()] == [set(header)] * len(times)


def test_sheets_of_the_joints_of_one_log_are_one_run(tmp_path):
    t = np.arange(0.0, 5.0, 0.01)
    sheets = {f"joint {i}": rows_of(["t", "q"], t, np.sin((i + 1.0) * t)) for i in range(3)}
    assert list(runs_of([saved(tmp_path / "a.xlsx", sheets)])) == ["a"]


def test_titles_stand_above_what_changes(tmp_path):
    """A log that was pasted with strokes between its blocks, zeros that nobody fills, and a figure beside a title."""
    t = np.arange(0.0, 2.0, 0.01)
    header = ["Time (ms)", None, None, "PosTar (deg)", None, None, "PosAct (deg)", 25.4, "Current (A)"]
    body = [[1e3 * x, 7 + i, "|", np.sign(x - 1.0), 0, 0, np.sin(x), "|", np.cos(x)] for i, x in enumerate(t)]
    found = read_tables(saved(tmp_path / "a.xlsx", {"log": [header, *body]}))
    assert {"Time (ms)", "PosTar (deg)", "PosAct (deg)", "Current (A)"} <= set(found)
    assert found["PosAct (deg)"] == pytest.approx(np.sin(t))
