"""`sher3 gap challenge`: ranges, and tables over finished folders."""

import json
import sys

import pytest
from invoking import invoke
from sher3_challenge.errors import ChallengeError
from sher3_gap_cli.app import app
from sher3_gap_cli.commands.challenge import parse_gap, parse_seeds, plants_of

ROW = {"case": "a", "truth": "no_gap", "said": "no_gap", "fault": "-", "answer": "-", "families": "-"}


def test_ranges():
    assert parse_seeds("3:7") == (3, 7)
    assert parse_gap("0.5:30") == (0.5, 30.0)


@pytest.mark.parametrize("text", ["3:1", "0:4", "2:101", "three"])
def test_a_gap_that_is_no_range_is_named(text):
    with pytest.raises(ChallengeError, match="not a range"):
        parse_gap(text)


def test_the_command_names_a_bad_range():
    result = invoke(app, ["challenge", "--seeds", "three"])
    assert result.exit_code == 2 and "seeds are not a range" in result.output


def test_finished_folders_are_printed_together(tmp_path):
    arguments = []
    for k, name in enumerate(("x", "y")):
        row = {**ROW, "case": name, "said_family": "-", "detected": False}
        kept = {"seeds": [k, k + 1], "seconds": 1.0, "errors": {}, "cases": {"diagnosis": [row]}}
        (tmp_path / name).mkdir()
        (tmp_path / name / "scores.json").write_text(json.dumps(kept))
        arguments += ["--merge", str(tmp_path / name)]
    result = invoke(app, ["challenge", *arguments])
    assert result.exit_code == 0 and "2 cases in 2 s" in result.output


def test_plants_that_are_left_out_are_told_with_the_extra_that_brings_them(monkeypatch):
    for name in [name for name in sys.modules if name.startswith("sher3_challenge.plants.mujoco")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    result = invoke(app, ["challenge", "--without", "gremlins"], COLUMNS="300")
    assert result.exit_code == 2 and "no such effect" in result.output
    assert "without plant mujoco" in result.output and "sher3[mujoco]" in result.output
    result = invoke(app, ["challenge", "--plant", "mujoco"])
    assert result.exit_code == 2 and "sher3[mujoco]" in result.output


def test_calibrate_names_a_folder_without_labels(tmp_path):
    result = invoke(app, ["calibrate", f"lumped={tmp_path}"])
    assert result.exit_code == 2 and "no labelled case" in result.output and str(tmp_path) in result.output


def test_calibrate_takes_several_folders_of_one_plant(tmp_path):
    for name in ("one", "two"):
        case = tmp_path / name / "case_1"
        case.mkdir(parents=True)
        (case / "case.yaml").write_text("")
        (case / "truth.yaml").write_text("case: case_1\n")
    found = plants_of([f"lumped={tmp_path / 'one'}", f"lumped={tmp_path / 'two'}", str(tmp_path / "one")])
    assert {name: len(cases) for name, cases in found.items()} == {"lumped": 2, "one": 1}


def test_calibrate_takes_the_plants_that_labels_name(tmp_path):
    for plant in ("tables", "mujoco"):
        case = tmp_path / f"case_{plant}"
        case.mkdir()
        (case / "case.yaml").write_text("")
        (case / "truth.yaml").write_text(f"plant: {plant}\n")
    found = plants_of([str(tmp_path)])
    assert {name: [c.name for c in cases] for name, cases in found.items()} == {
        "mujoco": ["case_mujoco"],
        "tables": ["case_tables"],
    }


def test_calibrate_adds_up_ranges_of_which_a_part_is_kept(tmp_path, monkeypatch):
    from sher3_challenge.calibration import drawn

    asked = []

    def draw(plants, seeds, kept, seconds):
        asked.append((list(seeds), seconds))
        return iter(())

    monkeypatch.setattr(drawn, "draw", draw)
    call = ["calibrate", "--in-force", "--plant", "tables", "--drawn", "0:3", "--drawn", "2:5", "--minutes", "0"]
    result = invoke(app, [*call, "--kept", str(tmp_path)])
    assert asked == [([0, 1, 2, 3, 4], 0.0)]
    assert "evidence of 0 of 5 drawn cases" in result.output
    assert result.exit_code == 2 and "no evidence of a cause" in result.output
