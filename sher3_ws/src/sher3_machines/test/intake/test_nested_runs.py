"""Runs within one JSON file: a list of records, each with its own samples."""

import json

import numpy as np
import pytest
from sher3_machines.intake.runs import runs_of
from sher3_machines.intake.tables import read_tables

LENGTHS = (60, 80, 50)
COLUMNS = [{"t": [0.01 * i for i in range(n)], "q": [float(i * n) for i in range(n)]} for n in LENGTHS]
ROWS = [[{"t": t, "q": q} for t, q in zip(run["t"], run["q"], strict=True)] for run in COLUMNS]
FORMS = {
    "lists": COLUMNS,
    "lists beside numbers": [{"mass": 0.5, "motor": "a", **run} for run in COLUMNS],
    "deeper": {"meta": {"by": "x"}, "trials": [{"load": 1, "data": run} for run in COLUMNS]},
    "rows": ROWS,
    "rows under a key": {"experiments": [{"kp": 3.0, "samples": run} for run in ROWS]},
    "named": {f"trial_{i}": run for i, run in enumerate(COLUMNS)},
}


@pytest.mark.parametrize("form", FORMS)
def test_each_record_of_a_list_is_a_run(tmp_path, form):
    (tmp_path / "a.json").write_text(json.dumps(FORMS[form]))
    runs = list(runs_of([tmp_path / "a.json"]).values())
    found = [{name.split("/")[-1]: x for name, x in run.items()} for run in runs]
    assert [len(run["t"]) for run in found] == list(LENGTHS)
    assert all(np.array_equal(run["q"], known["q"]) for run, known in zip(found, COLUMNS, strict=True))


def test_a_scan_or_joints_beside_each_sample_make_no_runs(tmp_path):
    scans = [{"t": 0.1 * i, "ranges": [1.0] * 40, "joints": [{"q": 1}, {"q": 2}]} for i in range(30)]
    (tmp_path / "a.json").write_text(json.dumps(scans))
    assert read_tables(tmp_path / "a.json")["ranges"].shape == (30, 40)
