"""Every path for every kind of machine: an answer, or one sentence that says what to do; never a traceback."""

import json
import re
from contextlib import suppress

import pytest
import sher3.gap as gap
from invoking import invoke
from kinds_of_cases import KINDS, table_of, written
from meaning import meaningless
from sher3_common import Sher3Error
from sher3_diagnosis.verdict import Verdict
from sher3_effects.registry import VARIABLE
from sher3_export.writing import TARGETS
from sher3_gap_cli.app import app
from sher3_machines import kinds, open_case

SENSORS = ("force_sensor", "weights")
"""Kinds of case of a sensor that the simulated robot has, too."""
FORMULAS = ("axes", "manipulator")
"""Kinds with a force balance, of which a formula is found."""
RUN = (*FORMULAS, "let_go")
"""Kinds that MuJoCo runs on what was recorded."""
DRAFTED = ("axes", "servo", "two_encoders", "let_go", "manipulator", "load_cell", "force_sensor", "positioning")
"""Kinds of which a table with names says enough."""
WRONG = ("nan", "inf", "None")
"""Words that no answer holds."""


def call(*words):
    found = invoke(app, words)
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
    assert "not expressed" not in answered("export", verdict, "--out", folder / "causes.yaml")
    applied = call("apply", verdict, "-o", folder / "effects.yaml")
    assert "sher3 gap export" in applied.output or kind in SENSORS  # the simulated robot has one, too
    checked = call("export", verdict, "--to", "mjcf", "--check", path, "--out", folder / "model.xml")
    assert (checked.exit_code == 0) == (kind in RUN), checked.output
    if kind in RUN:
        assert re.search(r"MuJoCo, \w+: [\d.]+ [mµ]?(m|rad) rms nominal, ", checked.output)
    assert "rivals" in answered("experiment", verdict, path, "-o", folder / "motion.csv")


def test_what_the_library_lacks_is_discovered_saved_and_found_again(case, monkeypatch):
    """Friction left out of the library: the formula is a cause of the next diagnosis, and of the exported model."""
    monkeypatch.setenv(VARIABLE, "")
    kind, path, folder = case
    out = ",".join(e.id for e in open_case(path)[0].library() if e.family in ("friction", "lost_motion"))
    words = ("--without", out) if out else ()
    found = call("discover", path, *words, "--save", folder / "found.yaml", "--json")
    assert kind not in FORMULAS or json.loads(found.stdout)["saved"]
    if not (folder / "found.yaml").exists():
        return
    again = folder / "again"
    told = json.loads(answered("diagnose", path, *words, "--library", folder / "found.yaml", "--out", again, "--json"))
    causes = told["cases"][0]["verdict"]["causes"]
    assert any(c["family"] == "found" for c in causes), causes
    made = answered("export", again / "verdict.json", "--library", folder / "found.yaml", "--out", folder / "all.yaml")
    assert kind not in FORMULAS or "friction in motion" in made
    assert "sher3 gap export" in call("apply", again / "verdict.json", "--library", folder / "found.yaml").output


def test_every_target_takes_a_verdict_or_says_why(case):
    _, _, folder = case
    verdict = folder / "verdict.json"
    for target in TARGETS:
        call("export", verdict, "--to", target, "--out", folder / f"{target}.out")
    assert " on " in answered("export", verdict, "--ranges", "--out", folder / "ranges.yaml")
    assert "nothing" not in (folder / "causes.yaml").read_text()


def test_an_answer_in_memory_shows_itself(case, tmp_path):
    described, columns = KINDS[case[0]](tmp_path)
    found = gap.diagnose(described, columns)
    assert not meaningless(found.verdict) and found.to_rows()
    shown = [str(found), found._repr_html_(), found.report(), str(found.corrected(to="yaml")), *found.notes]
    assert not any(word in WRONG for text in (shown[0], *shown[3:]) for word in text.split())
    found.plot()
    with suppress(Sher3Error):  # a table is not run again, nor what has no mass: one sentence says so
        assert found.simulate().joints


@pytest.mark.parametrize("kind", KINDS)
def test_a_draft_diagnoses_as_it_stands(kind, tmp_path):
    file, described = table_of(kind, tmp_path)
    words = ["--model", described["model"]] if "model" in described else []
    words += ["--rate", str(described["time"]["rate"])] if "rate" in described.get("time", {}) else []
    drafted = call("describe", file, *words, "--out", tmp_path / "draft.yaml").exit_code == 0
    assert drafted == (kind in DRAFTED)
    if drafted:
        answered("import", file, tmp_path / "draft.yaml", "--out", tmp_path / "case")
        told = json.loads(answered("diagnose", tmp_path / "case", "--out", tmp_path, "--no-report", "--json"))
        assert not meaningless(Verdict.model_validate(told["cases"][0]["verdict"]))
