"""Sealed cases: plans come from their seed, magnitudes meet their aim, labels say what was done, seals break."""

import json

import numpy as np
import pytest
import yaml
from sher3_bags import read_case
from sher3_challenge.calibration.held_out import judged_by
from sher3_challenge.calibration.observe import observations
from sher3_challenge.cases.builder import Request, build_case, withhold
from sher3_challenge.cases.calibrate import Calibration, sized
from sher3_challenge.cases.plan import KINDS, RECIPES, draw_plan
from sher3_challenge.cases.seal import CASES, LABELS, MANIFEST, check_seal, hashes
from sher3_challenge.errors import ChallengeError
from sher3_challenge.oracle.oracle import oracle
from sher3_challenge.plants.registry import plant_names, truth_plant
from sher3_challenge.run import requests
from sher3_description import load_robot
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.judge.costs import Costs
from sher3_gap import diagnose_case

ROBOT = load_robot()
LUMPED = truth_plant("lumped")


def essence(plan):
    return (
        plan.kind,
        [(f.kind.name, f.actuator, f.magnitude, f.seed) for f in plan.faults],
        [(r.excitation.label, r.repeat, r.excitation.posture, r.seed, r.stamp) for r in plan.runs],
        plan.climate,
    )


def test_a_seed_fixes_the_plan():
    assert (
        essence(draw_plan(ROBOT, 4, LUMPED))
        == essence(draw_plan(ROBOT, 4, LUMPED))
        != essence(draw_plan(ROBOT, 5, LUMPED))
    )


def test_plans_have_the_shape_of_practice_cases_and_the_mix_asked_for():
    plans = [draw_plan(ROBOT, seed, LUMPED) for seed in range(70)]
    counts = {kind: sum(p.kind == kind for p in plans) for kind in KINDS}
    assert counts["healthy"] >= 0.2 * len(plans) and min(counts.values()) > 0
    for p in plans:
        assert len(p.runs) == 9
        assert [r.repeat for r in p.runs[:6]] == [0, 1, 2, 0, 1, 2] and {r.repeat for r in p.runs[6:]} == {0}
        assert len({r.excitation.label for r in p.runs}) == 5
        assert len({r.seed for r in p.runs}) == 9
        assert len(p.faults) == {"healthy": 0, "single": 1, "outside": 1, "under_excited": 1}.get(p.kind, len(p.faults))
        if p.kind == "compound":
            assert len({f.kind.effect for f in p.faults}) == len(p.faults) >= 2
        if any(f.kind.stage in ("mechanism", "structure") for f in p.faults):
            assert p.tracker
        if p.kind == "under_excited":
            assert len(p.rivals) >= 2 and p.faults[0].kind.effect in p.rivals
            assert len({r.excitation.posture for r in p.runs}) == 1 and p.climate.rise == 0


def test_rivals_of_an_under_excited_case_are_of_different_families():
    family = {kind.effect: kind.family for kind in LUMPED.library.values()}
    assert all(len({family[name] for name in recipe.rivals}) >= 2 for recipe in RECIPES)


@pytest.mark.parametrize(("name", "aim"), [("coulomb_friction", 5.0), ("tool_offset", 12.0)])
def test_calibration_meets_its_aim(name, aim):
    plan = draw_plan(ROBOT, 21, LUMPED, kind="single", effect=name, gap=(aim, aim * 1.001))
    done, _ = sized(plan, ROBOT)
    assert Calibration(ROBOT, plan).ratio(done.faults[0]) == pytest.approx(aim, rel=0.15)


def test_exact_stages_and_healthy_cases_need_no_calibration():
    for kind, effect in (("healthy", None), ("single", "command_delay")):
        plan = draw_plan(ROBOT, 8, LUMPED, kind=kind, effect=effect)
        assert sized(plan, ROBOT) == (plan, {})


def test_oracle_counts_in_mean_squares():
    o = oracle(
        {"drive/roll": 1.0, "transport/all": 0.0},
        {"drive/roll": 8.0, "transport/all": 2.0},
        {"drive/roll": 0.5, "transport/all": 0.0},
    )
    assert (o["drive/roll"].L0, o["drive/roll"].gap_over_floor) == (9.0, 3.0)
    assert o["drive/roll"].closure == pytest.approx((8 - 0.5) / 8)
    assert o["transport/all"].gap_over_floor is None and o["transport/all"].closure == 1.0
    assert oracle({"drive/roll": 1.0}, {"drive/roll": 0.1}, {"drive/roll": 0.1})["drive/roll"].closure is None


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    folder = tmp_path_factory.mktemp("challenge")
    truth = build_case(Request(77, "single", "lead_error", gap=(6.0, 8.0)), folder / CASES, ROBOT)
    return folder, truth


def test_a_case_is_a_contract_case_that_says_nothing_of_its_fault(built):
    folder, truth = built
    case = read_case(folder / CASES / truth["case"])
    assert len(case.runs) == 9 and case.robot == ROBOT
    text = "".join(p.read_text() for p in (folder / CASES).rglob("*.yaml"))
    assert "lead_error" not in text and not list((folder / CASES).rglob("truth*"))
    for run in case.runs:
        assert run.metadata.origin == "plant" and "drives/setpoint_jv" in run and len(run["measured_js"]) == 2300
        assert not set(run.metadata.extra) and "lead" not in str(run.metadata.to_record())
    gap = case.runs[3]["measured_js"].position - case.runs[3]["drives/measured_js"].position
    j = ["delta_1", "delta_2", "delta_3", "roll", "tilt"].index(truth["effects"][0]["actuator"])
    assert (
        np.abs(gap[:, j]).max()
        > 3 * np.abs(np.delete(gap / ROBOT.actuators[j].motor_encoder, [j, 3], axis=1)).max() * 1e-7
    )


def test_the_label_has_the_schema_of_the_practice_truth(built):
    _, truth = built
    assert truth["schema"] == "sher3.truth/1" and truth["status"] == "attributed"
    effect = truth["effects"][0]
    assert {"stage", "also", "actuator", "effect", "family", "parameters", "company"} <= effect.keys()
    o = truth["oracle"][f"transmission/{effect['actuator']}"]
    assert 4.0 < o["gap_over_floor"] < 10.0 and 0.95 < o["closure"] <= 1.0
    assert o["gap_over_floor"] == pytest.approx((o["L0"] / o["F"]) ** 0.5)
    json.dumps(truth)


def test_a_withheld_effect_lies_outside(built):
    _, truth = built
    held = withhold(truth)
    assert held["status"] == "outside_library" and held["without"] == ["lead_error"]
    assert held["effects"][0]["family"] == "outside" and held["effects"][0]["withheld"] == "scale"


def test_a_broken_seal_is_named(built):
    folder, _ = built
    (folder / LABELS).mkdir()
    (folder / LABELS / "x.yaml").write_text("a: 1")
    manifest = hashes(folder / CASES) | hashes(folder / LABELS, LABELS)
    (folder / MANIFEST).write_text(json.dumps(manifest))
    check_seal(folder)
    (folder / LABELS / "x.yaml").write_text("a: 2")
    with pytest.raises(ChallengeError, match=r"changed after sealing.*labels/x\.yaml"):
        check_seal(folder)


def test_requests_deal_kinds_in_turn():
    dealt = requests((0, 4), ["healthy", "withheld"], plants=["lumped"])
    assert [(r.kind, r.withheld) for r in dealt] == [("healthy", False), ("single", True)] * 2
    only = requests((0, 3), without="cable_drag", plants=["lumped"])
    assert [r.effect for r in only] == ["cable_drag_axis", "cable_drag_sensor", "cable_drag_axis"]
    assert all(r.withheld for r in only)


def test_requests_deal_plants_in_turn_and_each_gets_every_kind():
    names = plant_names()
    dealt = requests((0, 2 * len(names)), ["healthy", "outside"])
    assert {(r.plant, r.kind) for r in dealt} == {(name, kind) for name in names for kind in ("healthy", "outside")}


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: requests((5, 5)), "number of cases"),
        (lambda: requests((0, 10**6)), "number of cases"),
        (lambda: requests((0, 2), ["odd"]), "no such kind"),
        (lambda: requests((0, 2), without="gremlins"), "no such effect"),
        (lambda: requests((0, 2), plants=["cardboard"]), "no such plant.*lumped"),
        (lambda: draw_plan(ROBOT, 1, LUMPED, kind="odd"), "no such kind"),
        (lambda: draw_plan(ROBOT, 1, LUMPED, kind="single", effect="gremlins"), "no such single fault"),
    ],
)
def test_bad_requests_are_named(call, words):
    with pytest.raises(ChallengeError, match=words):
        call()


@pytest.mark.slow
def test_what_calibration_reads_from_its_file_is_judged_as_verdicts_are(built, tmp_path):
    """One case, kept as plain data and read again, against the verdict on its folder; under four sets of costs."""
    folder, truth = built
    (folder / LABELS).mkdir(exist_ok=True)
    (folder / LABELS / f"{truth['case']}.yaml").write_text(yaml.safe_dump(truth), encoding="utf-8")
    case, kept = folder / CASES / truth["case"], tmp_path / "kept.json"
    observations("lumped", case, kept)
    seen = observations("lumped", case, kept)
    assert [o.without for o in seen] == [(), ("lead_error",)]
    for costs in (Costs(), Costs(name=1e4), Costs(abstain=1e4), Costs(miss=1e4)):
        found = [diagnose_case(case, without=o.without, costs=costs).verdict for o in seen]
        assert [j.said for j in judged_by(in_force(), seen, costs)] == [v.status for v in found], costs
        assert all(v.costs == costs.as_dict() for v in found)
