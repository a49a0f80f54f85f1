"""`sher3 gap export` as a user calls it."""

import json

import pytest
import yaml
from invoking import invoke
from sher3_chain.manipulator.description import BEHIND
from sher3_diagnosis.verdict import Interval
from sher3_export.check import check as checking
from sher3_export.check.check import Checked, JointGap
from sher3_gap_cli.app import app

VERDICT = {
    "schema": "sher3.verdict/1",
    "status": "attributed",
    "where": [
        {
            "stage": "motor_mechanics",
            "actuator": "a",
            "gap": 1.0,
            "floor": 0.1,
            "unit": "N",
            "regime": "",
            "confidence": 1,
        }
    ],
    "causes": [
        {
            "effect": "coulomb_friction",
            "family": "friction",
            "stage": "motor_mechanics",
            "actuator": "a",
            "parameters": {"force": {"value": 2.0, "low": 1.5, "high": 2.5, "unit": "N"}},
            "closure": {"value": 0.9},
        },
        {
            "effect": "transmission_ripple",
            "family": "periodic",
            "stage": "transmission",
            "actuator": "a",
            "parameters": {"amplitude": {"value": 0.1, "unit": "m"}},
            "closure": {"value": 0.1},
        },
    ],
}


@pytest.fixture
def call(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "verdict.json").write_text(json.dumps(VERDICT))
    (tmp_path / "m.xml").write_text(
        "<mujoco><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody></mujoco>"
    )
    return lambda *words: invoke(app, ["export", "verdict.json", *words])


def test_a_model_is_written_and_what_it_cannot_express_is_listed(call, tmp_path):
    found = call("--to", "mjcf", "--model", "m.xml", "--joint", "a=j", "--json")
    assert found.exit_code == 0, found.output
    data = json.loads(found.stdout)
    assert len(data["written"]) == 1 and data["not_expressed"][0].startswith("transmission_ripple on j")
    assert 'frictionloss="2"' in (tmp_path / "exported.xml").read_text()


def test_a_model_that_predicts_worse_is_not_written(call, tmp_path, monkeypatch):
    gaps = [
        JointGap("j", 0.18, 0.27, "rad", Interval(value=-1.0)),
        JointGap("k", 0.31, 0.22, "rad", Interval(value=0.5)),
    ]
    monkeypatch.setattr(checking, "check", lambda *given: Checked(None, gaps))
    found = call("--to", "mjcf", "--model", "m.xml", "--check", "case", "--out", "x.xml")
    assert found.exit_code == 2 and not (tmp_path / "x.xml").exists()
    assert "j: 0.18 rad nominal, 0.27 exported" in found.output and "without --check" in found.output


def test_a_motor_behind_a_coupling_is_a_tendon(call, tmp_path):
    found = call("--to", "mjcf", "--model", "m.xml", "--joint", "a=j", "--motor", "j=j:0.5")
    assert found.exit_code == 0, found.output
    assert '<joint joint="j" coef="0.5"' in (tmp_path / "exported.xml").read_text()


def test_ranges_are_written(call, tmp_path):
    assert call("--ranges", "--out", "r.yaml").exit_code == 0
    assert "sher3.ranges/1" in (tmp_path / "r.yaml").read_text()


def test_ranges_of_motors_behind_a_coupling_say_whose_they_are(call, tmp_path):
    (tmp_path / "verdict.json").write_text(json.dumps({**VERDICT, "notes": [f"{BEHIND}forces are the motors'"]}))
    refused = call("--ranges", "--out", "r.yaml")
    assert refused.exit_code == 2 and "no --motor" in refused.output and not (tmp_path / "r.yaml").exists()
    assert call("--ranges", "--motor", "a=j:0.5", "--out", "r.yaml").exit_code == 0
    assert yaml.safe_load((tmp_path / "r.yaml").read_text())["motors"] == {"a": {"j": 0.5}}


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("--to", "gazebo"), "no such target"),
        (("--to", "urdf"), "--model"),
        (("--to", "urdf", "--model", "m.xml"), "another kind of model"),
        (("--to", "mjcf", "--model", "none.xml"), "none.xml"),
        (("--to", "yaml", "--check", "."), "--to mjcf"),
        (("--joint", "a"), "AXIS=JOINT"),
        (("--motor", "a=j"), "MOTOR=JOINT:SHARE"),
        (("--out", "no/such/folder"), "--out"),
    ],
)
def test_what_cannot_be_done_is_one_sentence(call, words, named):
    found = call(*words)
    assert found.exit_code == 2 and named in found.output and "Traceback" not in found.output


def test_the_help_names_every_target():
    from sher3_export import TARGETS
    from sher3_gap_cli.commands.export import TARGETS as SAID

    assert set(SAID.replace(" or ", ", ").split(", ")) == set(TARGETS)


def test_a_bet_is_written_with_its_odds_where_the_verdict_abstains(call, tmp_path):
    friction, cogging = VERDICT["causes"]
    place = {k: VERDICT["where"][0][k] for k in ("stage", "actuator", "gap", "floor", "unit")}
    bet = {"causes": [friction], "probability": 0.3, "closure": {"value": 0.9}}
    lacks = {"answer": "outside_library", "probability": 0.65}
    abstains = VERDICT | {
        "schema": "sher3.verdict/3",
        "status": "outside_library",
        "causes": [],
        "unexplained": {"stage": "motor_mechanics", "actuator": "a", "signature": "largest everywhere"},
        "places": [{**place, "answers": [lacks, bet, {"causes": [cogging], "probability": 0.05}]}],
    }
    (tmp_path / "verdict.json").write_text(json.dumps(abstains))
    model = ("--to", "mjcf", "--model", "m.xml", "--joint", "a=j")
    assert "frictionloss" not in call(*model).output + (tmp_path / "exported.xml").read_text()
    found = call(*model, "--bet")
    assert found.exit_code == 0, found.output
    assert found.output.startswith("bet on     motor mechanics, a: Coulomb friction on a, 30 %, closes 90 %")
    assert 'frictionloss="2"' in (tmp_path / "exported.xml").read_text()
    (tmp_path / "verdict.json").write_text(json.dumps(VERDICT))
    refused = call(*model, "--bet")
    assert refused.exit_code == 2 and "lists no effect to bet on" in refused.output
