"""Scores: their meaning on hand-made verdicts, and agreement with the contract's own scorer."""

import importlib.util
import json
import os
from pathlib import Path

import numpy as np
import pytest
import yaml
from sher3_challenge.score.case import same_place, score_case
from sher3_challenge.score.intervals import parameter_coverage
from sher3_challenge.score.rates import summarise
from sher3_common.numbers.shares import wilson

SHARED = Path(os.environ.get("SHER3_SHARED", Path(__file__).resolve().parents[5] / "shared"))


def truth(status="attributed", effects=("backlash",), ratio=4.0, **more):
    family = {"backlash": "lost_motion", "coulomb_friction": "friction", "outside_library": "outside"}
    listed = [
        {
            "stage": "transmission",
            "also": ["mechanism"],
            "actuator": "tilt",
            "effect": effect,
            "family": family[effect],
            "parameters": {"width": 5e-6},
            "company": ["presliding_friction"],
        }
        for effect in effects
    ]
    oracle = {"transmission/tilt": {"L0": 1.0, "F": 0.1, "closure": 0.97, "gap_over_floor": ratio}}
    return {
        "schema": "sher3.truth/1",
        "case": "case_1",
        "status": status,
        "tracker": True,
        "effects": listed,
        "rivals": [],
        "oracle": oracle if effects else {},
        "tip": None,
        **more,
    }


def cause(effect="backlash", family="lost_motion", rivals=(), low=4e-6, high=6e-6):
    return {
        "effect": effect,
        "family": family,
        "stage": "transmission",
        "actuator": "tilt",
        "parameters": {"width": {"value": 5e-6, "low": low, "high": high, "unit": "m"}},
        "rivals": list(rivals),
    }


def verdict(status="attributed", causes=(), stage="transmission", actuator="tilt", closure=(0.95, 0.9, 0.99)):
    stated = dict(zip(("value", "low", "high"), closure, strict=True)) if closure else None
    where = [] if status == "no_gap" else [{"stage": stage, "actuator": actuator}]
    return {
        "status": status,
        "where": where,
        "causes": list(causes),
        "closure": {"stage": stated, "tip": None},
        "seconds": 1.5,
        "next_experiment": None,
    }


def test_a_right_answer_scores_everywhere():
    s = score_case(truth(), verdict(causes=[cause(rivals=["transmission_hysteresis"])]))
    assert s.detected and s.stage and s.actuator and s.family and s.top1 and s.in_set and s.single
    assert (s.set_size, s.recall, s.precision) == (2.0, 1.0, 1.0)
    assert s.closure_error == pytest.approx(0.02) and s.closure_inside
    assert (s.parameters, s.parameters_inside) == (1, 1)


def test_a_sibling_with_the_truth_as_rival_is_in_the_set_only():
    s = score_case(truth(), verdict(causes=[cause("transmission_hysteresis", rivals=["backlash"])]))
    assert not s.top1 and s.in_set and s.family and s.precision == 0.0 and s.recall == 0.0 and s.recall_in_sets == 1.0


def test_company_is_no_false_accusation():
    s = score_case(truth(), verdict(causes=[cause(), cause("presliding_friction", "friction")]))
    assert s.precision == 1.0


def test_missing_verdict_is_a_miss_unless_healthy():
    assert score_case(truth(), None).detected is False
    assert score_case(truth("no_gap", ()), None).detected is None
    assert score_case(truth("no_gap", ()), verdict(causes=[cause()])).false_attribution


def test_under_excited_needs_two_true_rivals():
    t = truth("under_excited", rivals=["backlash", "lead_error"])
    good = verdict("under_excited", [cause(rivals=["lead_error"])]) | {"next_experiment": {"excitation": "sweep"}}
    assert score_case(t, good).rivals and score_case(t, good).experiment
    assert not score_case(t, verdict(causes=[cause()])).rivals


@pytest.mark.parametrize(
    ("true", "said", "meets"),
    [("all", "roll", True), ("tip", "delta_1", True), ("delta_1", "all", True), ("delta_1", "delta_2", False),
     ("force_sensor", "tip", True), ("force_sensor", "all", False), ("roll", None, False)],
)  # fmt: skip
def test_places(true, said, meets):
    assert same_place(true, said) is meets


def test_intervals():
    low, high = wilson(0.0, 50)
    assert low == 0.0 and 0.06 < high < 0.08  # the exact one-sided bound 3/n is close to it
    assert parameter_coverage({"parameters": {"force": -2.0}}, {"parameters": {"Fc": {"low": 1.5, "high": 2.5}}}) == (
        1,
        1,
    )


def test_summary_filters_by_gap_and_bins_it():
    rows = [
        score_case(truth(ratio=r), verdict(causes=[cause()]) if r > 2 else verdict("no_gap"))
        for r in (1.2, 1.8, 4.0, 20.0)
    ]
    assert summarise(rows).rates["detection"].value == 0.5
    high = summarise(rows, least=3.0)
    assert high.rates["detection"].value == 1.0 and high.rates["detection"].n == 2
    assert [row["n"] for row in high.detectability] == [1, 1, 1, 1]
    assert high.status_confusion == {"attributed": {"attributed": 2}}
    assert json.dumps(high.as_dict())


PAIRS = {
    "detection": "detection_rate", "false_alarm": "false_alarm_rate", "stage": "stage_accuracy",
    "actuator": "actuator_accuracy", "top1": "single_top1", "in_set": "single_in_set", "family": "single_family",
    "set_size": "single_set_size", "precision": "single_precision", "closure_error": "closure_abs_error",
    "closure_interval_coverage": "closure_interval_coverage", "tip_closure_error": "tip_closure_abs_error",
    "compound_recall": "compound_recall", "compound_recall_in_sets": "compound_recall_in_sets",
    "compound_precision": "compound_precision", "outside_abstention": "outside_library_recall",
    "outside_false_attribution": "outside_false_attribution",
    "healthy_false_attribution": "healthy_false_attribution", "under_excited_abstention": "under_excited_recall",
    "under_excited_rivals": "under_excited_rivals", "parameter_interval_coverage": "parameter_interval_coverage",
    "seconds": "seconds",
}  # fmt: skip


def random_pairs(n, seed):
    rng = np.random.default_rng(seed)
    for i in range(n):
        status = str(rng.choice(["no_gap", "attributed", "under_excited", "outside_library"]))
        effects = {"no_gap": (), "outside_library": ("outside_library",)}.get(status, ("backlash", "coulomb_friction"))
        if status == "attributed" and rng.random() < 0.6:
            effects = effects[:1]
        tip = {"tip": {"closure": 0.8}, "tip_free": {"closure": None}} if rng.random() < 0.5 else None
        t = truth(status, effects, float(rng.uniform(1, 20)), rivals=["backlash", "lead_error"], tip=tip)
        t["case"] = f"case_{i:03d}"
        names = [
            ("backlash", "lost_motion"),
            ("coulomb_friction", "friction"),
            ("presliding_friction", "friction"),
            ("lead_error", "scale"),
        ]
        causes = [
            cause(
                *names[rng.integers(4)], ["lead_error"] * int(rng.random() < 0.4), low=float(rng.choice([4e-6, 6e-6]))
            )
            for _ in range(rng.integers(0, 3))
        ]
        said = str(rng.choice(["no_gap", "attributed", "under_excited", "outside_library"]))
        stage, actuator = str(rng.choice(["transmission", "mechanism", "drive"])), str(rng.choice(["tilt", "roll"]))
        v = verdict(said, causes, stage, actuator,
                    (float(rng.uniform(0, 1)), 0.5, 0.99) if rng.random() < 0.8 else None)  # fmt: skip
        if v["closure"]["stage"] and rng.random() < 0.5:
            v["closure"]["tip"] = {"value": 0.7}
        yield t, None if rng.random() < 0.1 else v


@pytest.mark.shared
@pytest.mark.skipif(not (SHARED / "contract/score.py").exists(), reason="shared/contract/score.py is not there")
def test_agrees_with_the_scorer_of_the_contract(tmp_path):
    spec = importlib.util.spec_from_file_location("contract_score", SHARED / "contract/score.py")
    theirs = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(theirs)
    pairs = list(random_pairs(160, 7))
    for t, v in pairs:
        (tmp_path / f"{t['case']}.yaml").write_text(yaml.safe_dump(t))
        if v is not None:
            (tmp_path / f"{t['case']}.json").write_text(json.dumps(v))
    expected = theirs.totals(theirs.score(theirs.load(tmp_path, tmp_path)))
    ours = summarise([score_case(t, v) for t, v in pairs]).rates
    for mine, other in PAIRS.items():
        value, n = expected[other]
        assert ours[mine].n == n, mine
        assert ours[mine].value == (None if value is None else pytest.approx(value)), mine


def test_stated_probabilities_are_kept_with_whether_they_were_right():
    """A true cause at 0.9, its company at 0.6, an outside that is none at 0.2; what sums above one is one."""
    named = [{**cause(), "probability": 0.9}, {**cause("presliding_friction", "friction"), "probability": 0.6}]
    said = verdict(causes=named) | {"probabilities": {"outside_library": 0.2}}
    assert score_case(truth(), said).stated == [(0.9, True), (0.6, True), (0.2, False)]
    blamed = score_case(truth(status="outside_library", effects=()), said | {"probabilities": {"outside_library": 1.3}})
    assert blamed.stated == [(0.9, False), (0.6, False), (1.0, True)]
    error = summarise([blamed]).rates["calibration_error"]
    assert (error.value, error.n) == (pytest.approx((0.9 + 0.6 + 0.0) / 3.0), 3)
