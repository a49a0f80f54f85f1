"""`sher3 gap diagnose`, `apply` and `library`: files, exit codes, the report, one case or many."""

import json
import re
import shutil

import pytest
from invoking import invoke
from sher3_bags import write_case
from sher3_diagnosis.verdict import Cause, Interval, Parameter, Verdict, Where
from sher3_effects import library, load_effects, plants
from sher3_effects.registry import every
from sher3_gap_cli.answers import Task, answer, check_effects, folders
from sher3_gap_cli.app import app
from sher3_gap_cli.options import RequestError
from sher3_gap_cli.workers import run_on_dask
from simulated import ROBOT, runs_of

TRUTH = plants()["coulomb_friction"]("delta_2", force=1.2)


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    runs = runs_of(["sweep", "reversals"], [TRUTH], repeats=3, duration=3.0)
    return write_case(tmp_path_factory.mktemp("cases") / "rubbing", runs, ROBOT)


@pytest.fixture(scope="module")
def answered(case, tmp_path_factory):
    out = tmp_path_factory.mktemp("out")
    result = invoke(app, ["diagnose", str(case), "--out", str(out)])
    assert result.exit_code == 0, result.output
    return out, result


def test_diagnose_says_it_in_five_lines_and_writes_both_files(answered):
    out, result = answered
    lines = [line for line in result.stdout.splitlines() if line.strip()]
    assert [line.split()[0] for line in lines[:5]] == ["verdict", "where", "cause", "closure", "next"]
    assert "Coulomb friction on delta 2" in lines[2]
    verdict = Verdict.read(out / "verdict.json")
    assert verdict.status == "attributed"
    assert (verdict.causes[0].effect, verdict.causes[0].actuator) == ("coulomb_friction", "delta_2")


def test_the_report_stands_alone_and_has_every_section(answered):
    page = (answered[0] / "report.html").read_text()
    assert not re.findall(r'(?:src|href)="(?!#)[^"]+"', page)
    assert not re.findall(r"url\((?!#)", page)
    assert "@import" not in page and "<script src" not in page
    for heading in ("Where the gap is", "What causes it", "How far the gap shrinks", "Real, nominal, corrected"):
        assert f"<h2>{heading}</h2>" in page
    for heading in ("In which regimes it lives", "What these topics can tell apart"):
        assert f"<h2>{heading}</h2>" in page
    assert library()["coulomb_friction"].explanation in page
    assert page.count('<svg role="img"') >= 2 and page.count('class="bar shut') >= 2


def test_apply_shrinks_the_gap_end_to_end(answered, case, tmp_path):
    effects = tmp_path / "effects.yaml"
    command = ["apply", str(answered[0] / "verdict.json"), "-o", str(effects), "--case", str(case), "--json"]
    result = invoke(app, command)
    assert result.exit_code == 0, result.output
    (effect,) = load_effects(effects)
    assert (effect.id, effect.actuator) == ("coulomb_friction", "delta_2")
    assert effect.force == pytest.approx(TRUTH.force, rel=0.1)
    stages = {(s["stage"], s["actuator"]): s for s in json.loads(result.stdout)["stages"]}
    rubbing = stages["motor_mechanics", "delta_2"]
    assert rubbing["closure"] > 0.9 and rubbing["after"] < 0.35 * rubbing["before"]
    assert stages["motor_mechanics", "delta_1"]["after"] < 1.5 * stages["motor_mechanics", "delta_1"]["floor"]


def test_several_cases_in_parallel_and_one_of_them_broken(case, tmp_path):
    broken = shutil.copytree(case, tmp_path / "broken")
    next((broken / "run_00").glob("*.mcap")).write_bytes(b"no bag")
    options = ["--out", str(tmp_path / "o"), "--jobs", "2", "--no-report", "--json"]
    result = invoke(app, ["diagnose", str(case), str(broken), *options])
    assert result.exit_code == 2
    answers = {entry["case"]: entry for entry in json.loads(result.stdout)["cases"]}
    assert "error" in answers[str(broken)]
    assert answers[str(case)]["verdict"]["status"] == "attributed"
    assert (tmp_path / "o" / case.name / "verdict.json").is_file()


def test_dask_gives_the_same_verdict(answered, case):
    distributed = pytest.importorskip("distributed")
    loopback = {"protocol": "tcp://", "host": "127.0.0.1", "dashboard_address": None}
    options = {"n_workers": 1, "threads_per_worker": 1, "processes": False, **loopback}
    with distributed.LocalCluster(**options) as cluster:
        (found,) = run_on_dask(answer, [Task(case, report=False)], cluster.scheduler_address)
    here = Verdict.read(answered[0] / "verdict.json")
    same = {"seconds": 0.0}
    assert found.verdict.model_copy(update=same) == here.model_copy(update=same)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["diagnose", "nowhere"], "nowhere: no such folder; name a case folder"),
        (["diagnose", "nowhere", "--without", "gremlins"], "no such effect"),
        (["apply", "nowhere.json"], "no such file"),
        (["experiment", "nowhere.json"], "no such file"),
        (["library", "gremlins"], "no such effect or family"),
    ],
)
def test_bad_requests_end_with_one_sentence_and_code_2(arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = invoke(app, arguments)
    assert result.exit_code == 2
    assert words in result.stderr and "Traceback" not in result.output
    assert "reading" not in result.stderr


@pytest.mark.parametrize(
    ("arguments", "remedy"),
    [
        (["apply", "arm.json"], "sher3 gap export"),
        (["apply", "arm.json", "--case", "arm"], "sher3 gap export"),
        (["compare", "arm", "arm"], "conditions"),
        (["experiment", "arm.json"], "give its case too"),
        (["experiment", "arm.json", "--ran", "arm"], "diagnose the new case"),
    ],
)
def test_another_machine_is_refused_with_what_to_do_instead(arguments, remedy, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm").mkdir()
    (tmp_path / "arm/machine.yaml").write_text("kind: manipulator\n")
    cause = Cause(
        effect="backlash",
        family="lost_motion",
        stage="transmission",
        actuator="elbow",
        parameters={"width": Parameter(value=1e-3, unit="rad")},
        closure=Interval(value=0.9, low=0.8, high=1.0),
    )
    at = {"stage": "transmission", "actuator": "elbow", "regime": "everywhere", "confidence": 1.0}
    where = Where(gap=1e-3, floor=1e-6, unit="rad", **at)
    Verdict(status="attributed", where=[where], causes=[cause]).write(tmp_path / "arm.json")
    result = invoke(app, arguments)
    assert result.exit_code == 2 and "another machine" in result.stderr and remedy in result.stderr


def test_a_verdict_without_causes_has_nothing_to_apply(tmp_path):
    Verdict(status="no_gap").write(tmp_path / "verdict.json")
    result = invoke(app, ["apply", str(tmp_path / "verdict.json")])
    assert result.exit_code == 2 and "no cause" in result.stderr


def test_library_lists_every_effect():
    rows = json.loads(invoke(app, ["library", "--json"]).stdout)["effects"]
    assert {row["effect"] for row in rows} == set(every()) > set(library())
    assert all(row["explanation"].strip() and row["parameters"] for row in rows)


def test_output_folders(tmp_path):
    a, b = tmp_path / "x" / "case", tmp_path / "y" / "case"
    assert folders([a], tmp_path) == {a: tmp_path}
    with pytest.raises(RequestError, match="same name"):
        folders([a, b], tmp_path)
    assert check_effects(["backlash,cogging", "lead_error"]) == ("backlash", "cogging", "lead_error")
