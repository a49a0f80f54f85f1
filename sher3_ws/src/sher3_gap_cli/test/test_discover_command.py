"""`sher3 gap discover`: found, saved, found again by the diagnosis, put into the simulator, and the gap shrinks."""

import json

import pytest
from invoking import invoke
from sher3_bags import write_case
from sher3_effects import add_library, plants
from sher3_effects.registry import VARIABLE
from sher3_gap_cli.app import app
from simulated import ROBOT, runs_of

TRUTH = """
schema: sher3.found/1
effect: drag
stage: motor_mechanics
sites: [delta_2]
explanation: drag that grows with the square of speed
terms: [{feature: signed_square(velocity), coefficient: 3.0e4, unit: N/(m/s)^2}]
"""


def output_of(*words):
    result = invoke(app, words)
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.fixture(scope="module")
def dragged(tmp_path_factory):
    folder = tmp_path_factory.mktemp("drag")
    (folder / "truth.yaml").write_text(TRUTH)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(VARIABLE, "")
        add_library([folder / "truth.yaml"])
        effect = plants()["drag"]("delta_2")
        runs = runs_of(["sweep", "reversals"], [effect], repeats=3, duration=3.0)
    return write_case(folder / "dragged", runs, ROBOT)


def test_from_an_unknown_gap_to_a_corrected_simulator(dragged, tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    page = tmp_path / "found.yaml"
    text = output_of("discover", dragged, "--place", "motor_mechanics/delta_2", "--save", page, "--out", tmp_path)
    assert "signed_square(velocity)" in text and "in proportion to the square of the velocity" in text
    assert "boosted trees" in text and str(page) in text
    assert "A formula for it" in (tmp_path / "report.html").read_text()
    told = json.loads(output_of("diagnose", dragged, "--library", page, "--out", tmp_path, "--no-report", "--json"))
    (cause,) = told["cases"][0]["verdict"]["causes"]
    assert cause["effect"] == "found_motor_mechanics_delta_2"
    assert cause["parameters"]["coefficient_1"]["value"] == pytest.approx(3.0e4, rel=0.05)
    effects = tmp_path / "corrected.yaml"
    words = ("apply", tmp_path / "verdict.json", "-o", effects, "--case", dragged, "--library", page, "--json")
    stages = {(s["stage"], s["actuator"]): s["closure"] for s in json.loads(output_of(*words))["stages"]}
    assert stages["motor_mechanics", "delta_2"] > 0.9
    assert "found.yaml" in effects.read_text()


def test_a_healthy_case_has_no_formula(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    case = write_case(tmp_path / "healthy", runs_of(["sweep", "steps"], repeats=3, duration=2.0), ROBOT)
    told = json.loads(output_of("discover", case, "--save", tmp_path / "none.yaml", "--json"))
    assert told["terms"] == [] and told["note"] == "nothing to discover: there is no gap" and told["saved"] is None
    assert not (tmp_path / "none.yaml").exists()


@pytest.mark.parametrize(("place", "what"), [("moon/tilt", "no such place"), ("transport/tilt", "no formula can")])
def test_a_place_without_a_residual_is_refused(dragged, place, what):
    result = invoke(app, ["discover", str(dragged), "--place", place])
    assert result.exit_code == 2 and what in result.output
