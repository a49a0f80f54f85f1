"""`sher3 gap describe` and `sher3 gap case` as a user calls them."""

import json

import numpy as np
import pytest
from invoking import invoke
from sher3_bags import Run, RunMetadata, stream, write_run
from sher3_description import load_robot
from sher3_gap_cli.app import app


def call(*words):
    return invoke(app, words)


def test_a_description_is_drafted_and_its_guesses_are_said(tmp_path):
    time = np.arange(0.0, 2.0, 0.01)
    np.savetxt(tmp_path / "a.csv", np.column_stack([time, np.sin(time)]), delimiter=",", header="t,q", comments="")
    found = call("describe", tmp_path / "a.csv", "--out", tmp_path / "a.yaml")
    assert found.exit_code == 0 and "guessed: time is the column 't'" in found.output
    assert json.loads(call("describe", tmp_path / "a.csv", "--json").stdout)["guesses"]
    assert call("describe", tmp_path / "gone.csv").exit_code == 2


@pytest.mark.parametrize("names", [("a", "b")])
def test_a_case_is_made_of_recordings(tmp_path, names):
    rows = np.zeros((20, 5))
    streams = {"drives/measured_js": stream("drives/measured_js", 10**9 + 2_000_000 * np.arange(20), position=rows)}
    for name in names:
        write_run(tmp_path / name, Run(streams, RunMetadata("sweep", 0, 1.0), load_robot().to_yaml()))
    bags = [tmp_path / name for name in names]
    found = call("case", *bags, "--out", tmp_path / "case", "--json")
    assert [x["repeat"] for x in json.loads(found.stdout)["runs"]] == [0, 1]
    again = call("case", *bags, "--out", tmp_path / "case")
    assert again.exit_code == 2 and "exists already" in again.output
