"""Every path for every kind of machine: an answer, or one sentence that says what to do; never a traceback."""

import json

import pytest
from kinds_of_cases import KINDS, written
from sher3_effects.registry import VARIABLE
from sher3_gap_cli.app import app
from sher3_machines import kinds, open_case
from typer.testing import CliRunner

SENSORS = ("force_sensor", "weights")
"""Kinds of case of a sensor that the simulated robot has, too."""
FORMULAS = ("axes", "manipulator")
"""Kinds with a force balance, of which a formula is found."""


def call(*words):
    found = CliRunner().invoke(app, [str(w) for w in words])
    assert found.exception is None or isinstance(found.exception, SystemExit), found.exception
    assert found.exit_code in (0, 2), found.output
    assert found.exit_code == 0 or found.output.count("sher3: ") == 1, found.output
    return found


def answered(*words):
    found = call(*words)
    assert found.exit_code == 0, found.output
    return found.stdout


def adds_up(verdict):
    """Every place of a verdict has bets, and these add up to one."""
    assert len(verdict["places"]) >= len(verdict["where"])
    for place in verdict["places"]:
        assert sum(a["probability"] for a in place["answers"]) + place["other"] == pytest.approx(1.0, abs=1e-6)


def test_every_kind_has_a_case(tmp_path):
    assert {KINDS[name](tmp_path)[0]["kind"] for name in KINDS} == set(kinds())


@pytest.fixture(scope="module", params=list(KINDS))
def case(request, tmp_path_factory):
    """Name of a kind, its case, and the folder with its verdict."""
    folder = tmp_path_factory.mktemp(request.param)
    data, description = written(request.param, folder)
    answered("import", data, description, "--out", folder / "case")
    told = json.loads(answered("diagnose", folder / "case", "--out", folder, "--json"))
    verdict = told["cases"][0]["verdict"]
    assert verdict["causes"], told
    adds_up(verdict)
    bets = [next((a for a in p["answers"] if a["causes"]), None) for p in verdict["places"]]
    assert any(bets) and all(b is None or b["closure"] for b in bets)
    return request.param, folder / "case", folder


def test_any_effect_may_be_left_out(case):
    _, path, folder = case
    known = [e.id for e in open_case(path)[0].library()]
    told = json.loads(answered("diagnose", path, "--without", ",".join(known), "--out", folder / "none", "--json"))
    verdict = told["cases"][0]["verdict"]
    assert verdict["causes"] == []
    adds_up(verdict)
    assert call("diagnose", path, "--without", "wet_friction", "--no-report").exit_code == 2


def test_a_verdict_is_exported_and_an_experiment_proposed_or_refused_in_a_sentence(case):
    kind, path, folder = case
    verdict = folder / "verdict.json"
    assert answered("export", verdict, "--out", folder / "causes.yaml")
    applied = call("apply", verdict, "-o", folder / "effects.yaml")
    assert "sher3 gap export" in applied.output or kind in SENSORS  # the simulated robot has one, too
    checked = call("export", verdict, "--to", "mjcf", "--check", path, "--out", folder / "model.xml")
    assert (checked.exit_code == 0) == (kind in FORMULAS), checked.output
    call("experiment", verdict, path, "-o", folder / "motion.csv")


def test_what_the_library_lacks_is_discovered_saved_and_found_again(case, monkeypatch):
    """Friction left out of the library: the formula is a cause of the next diagnosis, and of the exported model."""
    monkeypatch.setenv(VARIABLE, "")
    kind, path, folder = case
    out = ",".join(e.id for e in open_case(path)[0].library() if e.family in ("friction", "lost_motion"))
    words = ("--without", out) if out else ()
    found = call("discover", path, *words, "--save", folder / "found.yaml", "--json")
    if kind not in FORMULAS:
        assert not (folder / "found.yaml").exists()
        return
    assert json.loads(found.stdout)["saved"]
    again = folder / "again"
    told = json.loads(answered("diagnose", path, *words, "--library", folder / "found.yaml", "--out", again, "--json"))
    causes = told["cases"][0]["verdict"]["causes"]
    assert any(c["family"] == "found" for c in causes), causes
    made = answered("export", again / "verdict.json", "--library", folder / "found.yaml", "--out", folder / "all.yaml")
    assert "friction in motion" in made
    assert "sher3 gap export" in call("apply", again / "verdict.json", "--library", folder / "found.yaml").output
