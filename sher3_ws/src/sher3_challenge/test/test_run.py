"""A whole challenge: built, sealed, diagnosed in other processes, scored; labels out of sight until the end."""

import json
import os
from io import StringIO

import pytest
import yaml
from joblib import delayed
from rich.console import Console
from sher3_challenge.answers.diagnosis import Answers, ask
from sher3_challenge.cases.builder import Request
from sher3_challenge.cases.seal import CASES, LABELS, check_seal
from sher3_challenge.errors import ChallengeError
from sher3_challenge.run import in_processes, run_challenge, score_all
from sher3_challenge.score.outcome import Outcome, merged
from sher3_challenge.score.rates import summarise
from sher3_challenge.score.tables import TARGETS, print_outcome


def test_scores_are_kept_by_competitor():
    truth = {"case": "a", "status": "no_gap", "effects": [], "oracle": {}, "tip": None, "rivals": []}
    answers = {"a": Answers({"status": "no_gap"}, {"best_rmse": {"status": "attributed", "causes": []}})}
    scores = score_all([truth], answers)
    assert scores["diagnosis"][0].detected is False and scores["best_rmse"][0].detected is True
    assert set(TARGETS) <= set(summarise(scores["diagnosis"]).rates)


def test_an_error_of_the_diagnosis_is_a_missing_verdict(tmp_path):
    given = ask(tmp_path / "nothing", (), False)
    assert given.verdict is None and given.error is not None and "nothing" in given.error


def test_one_job_is_one_other_process():
    first, second = (set(in_processes(1, [delayed(os.getpid)() for _ in range(4)])) for _ in range(2))
    assert len(first) == len(second) == 1
    assert not first & second and os.getpid() not in first | second


def test_an_existing_folder_is_left_alone(tmp_path):
    with pytest.raises(ChallengeError, match="exists already"):
        run_challenge(tmp_path, [Request(1)])


def kept(folder, *names, first=0, plant="lumped"):
    """A finished challenge's folder with a right verdict on each named healthy robot."""
    healthy = {"status": "no_gap", "effects": [], "oracle": {}, "tip": None, "rivals": [], "plant": plant}
    truth = [{"case": n, **healthy} for n in names]
    scores = score_all(truth, {n: Answers({"status": "no_gap"}, {}) for n in names})
    folder.mkdir()
    outcome = Outcome(scores, 1.0, (first, first + len(names)), {})
    (folder / "scores.json").write_text(json.dumps(outcome.as_dict()), encoding="utf-8")
    return folder


def test_folders_are_scored_together(tmp_path):
    folders = [kept(tmp_path / "a", "x", "y"), kept(tmp_path / "b", "z", first=2)]
    both = merged(folders)
    assert both.seeds == (0, 3) and both.seconds == 2.0
    assert both.summary().rates["false_alarm"].n == 3


def test_plants_have_a_column_each_and_the_same_seed_on_two_plants_is_two_cases(tmp_path):
    outcome = merged([kept(tmp_path / "a", "x", plant="lumped"), kept(tmp_path / "b", "x", plant="tables")])
    assert outcome.plants == ("lumped", "tables")
    assert outcome.as_dict()["by_plant"]["tables"]["rates"]["false_alarm"]["n"] == 1
    console = Console(width=160, record=True, file=StringIO())
    print_outcome(outcome, console)
    title = next(line for line in console.export_text().splitlines() if "lumped" in line and "tables" in line)
    assert "target" in title


def test_a_case_counts_once(tmp_path):
    folder = kept(tmp_path / "a", "x")
    with pytest.raises(ChallengeError, match="two folders"):
        merged([folder, folder])
    with pytest.raises(ChallengeError, match="no scores"):
        merged([tmp_path / "nothing"])
    for other in ({}, {"cases": {"diagnosis": [{"case": "x"}]}}, []):
        (folder / "scores.json").write_text(json.dumps(other), encoding="utf-8")
        with pytest.raises(ChallengeError, match="no scores"):
            merged([folder])


@pytest.mark.slow
def test_a_whole_challenge(tmp_path):
    out = tmp_path / "challenge"
    wanted = [
        Request(31, "healthy"),
        Request(32, "single", "lead_error", gap=(9, 10)),
        Request(33, "single", "force_bias", True, gap=(9, 10)),
    ]
    said = []
    outcome = run_challenge(out, wanted, jobs=2, say=said.append)
    check_seal(out)
    assert len(said) == 2 and outcome.seeds == (31, 34)
    rows = {row.case: row for row in outcome.scores["diagnosis"]}
    assert rows["case_00032"].detected and rows["case_00032"].stage and rows["case_00032"].actuator
    assert rows["case_00033"].truth == "outside_library"
    assert "force_bias" not in rows["case_00033"].answer  # it had to do without
    assert {"best_rmse", "iid_bic", "all_parameters", "trace_metrics"} < set(outcome.scores)
    stored = json.loads((out / "scores.json").read_text())
    assert stored["seeds"] == [31, 34] and set(stored["all"]) == set(outcome.scores)
    assert sorted(p.name for p in (out / LABELS).iterdir()) == [f"case_000{n}.yaml" for n in (31, 32, 33)]
    assert yaml.safe_load((out / LABELS / "case_00031.yaml").read_text())["status"] == "no_gap"
    assert not list((out / CASES).rglob("*label*"))


def test_tables_show_targets_intervals_and_errors():
    truth = {"case": "a", "status": "no_gap", "effects": [], "oracle": {}, "tip": None, "rivals": [], "plant": "lumped"}
    scores = score_all([truth], {"a": Answers({"status": "no_gap"}, {"best_rmse": {"status": "attributed"}})})
    console = Console(width=100, record=True, file=StringIO())
    print_outcome(Outcome(scores, 2.0, (7, 8), {"b": "CaseError: cut"}), console)
    text = console.export_text()
    row = next(line for line in text.splitlines() if "false_alarm" in line)
    assert "<= 0.02" in row and "0.000 0.00-0.79 (n 1)" in row and "1.00" in row
    assert "b: no verdict, CaseError: cut" in text and "seeds 7:8" in text
