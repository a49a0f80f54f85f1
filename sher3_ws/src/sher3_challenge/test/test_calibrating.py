"""The calibration: labels to answers, fits by hand, sets that cover, and what is quoted of a plant left out."""

import json
from dataclasses import replace

import numpy as np
import pytest
from sher3_challenge.calibration.fit import (
    Example,
    calibrated,
    conformal,
    ends,
    logistic,
    placed_among,
    sharpness,
    updated,
    weights,
)
from sher3_challenge.calibration.held_out import by_build, by_shape, groups, held_out, judged_by
from sher3_challenge.calibration.labels import answer_of, same_data
from sher3_challenge.calibration.observe import Observation, keep, labelled, stored, truth_of
from sher3_challenge.calibration.table import rates, written
from sher3_challenge.errors import ChallengeError
from sher3_challenge.score.reliability import bins, calibration_error, diagram
from sher3_common import FileError
from sher3_diagnosis.judge.calibration.calibration import Calibration

NUMBERS = {
    "left": 0.01, "law": 0.01, "place": 0.01, "anything": 0.01, "spread": 0.001,
    "mismatch": 0.02, "ratio": 6.0, "power": 36.0, "idealised": 1.0,
}  # fmt: skip
BAD = {"left": 0.6, "law": 0.5, "anything": 0.1, "spread": 0.2, "lost": 0.2, "mismatch": 0.5}
RIVAL = {"presliding_friction": 0.5, "viscous_friction": 20.0}


def cause(effect="coulomb_friction", others=RIVAL, **changes):
    names = {effect: 0.0, **others}
    return {
        "channel": "motor_mechanics/tilt", "index": 0, "numbers": NUMBERS | changes, "family": "friction",
        "stage": "motor_mechanics", "closure": {"value": 0.9, "low": 0.8, "high": 1.0},
        "candidates": [
            {"effect": n, "site": "tilt", "family": "friction", "contains": [], "unlikeness": u}
            for n, u in names.items()
        ],
    }  # fmt: skip


def gap(channel="drive/tilt", power=20.0, beside=0.0):
    numbers = {"power": power, "ratio": 4.0, "beside": beside, "others": 0.0}
    return {"channel": channel, "index": None, "numbers": numbers, "candidates": []}


def seen(
    status="attributed", effect="coulomb_friction", items=(), without=(), exact=(), plant="a", case="c", stage=None
):
    family = "outside" if status == "outside_library" else "friction"
    effects = [
        {"stage": stage or "motor_mechanics", "also": [], "actuator": "tilt", "effect": effect, "family": family}
    ]
    truth = {
        "status": status, "effects": [] if status == "no_gap" else effects, "rivals": [],
        "oracle": {"x": {"gap_over_floor": 5.0}},
    }  # fmt: skip
    return Observation(plant, case, truth, tuple(without), tuple(items), (), (), False)


def test_a_cause_is_right_when_it_or_one_that_explains_the_data_alike_is_true():
    right = seen(items=[cause()])
    assert answer_of(right, right.items[0], right) == "library"
    alike = seen(items=[cause("presliding_friction", {"coulomb_friction": 0.4})])
    assert answer_of(alike, alike.items[0], alike) == "library"


def test_a_relative_of_an_effect_left_out_imitates_it():
    whole = seen(items=[cause("viscous_friction", {"cogging": 30.0})], effect="viscous_friction")
    left_out = seen(effect="viscous_friction", items=[cause("cogging", {}, left=0.1)], without=("viscous_friction",))
    assert answer_of(left_out, left_out.items[0], whole) == "outside_library"


def test_one_that_gives_the_same_data_or_contains_the_effect_is_no_mistake():
    whole = seen(items=[cause(others={"cogging": 0.5})])
    twin = seen(items=[cause("cogging", {})], without=("coulomb_friction",))
    assert answer_of(twin, twin.items[0], whole) is None
    containing = seen(items=[cause("presliding_friction", {})], without=("coulomb_friction",))
    assert answer_of(containing, containing.items[0], seen(items=[cause()])) in (None, "library")


def test_several_effects_that_together_leave_as_little_as_the_true_one_give_the_same_data():
    """A gap of 6 floors, power 36: left 0.01 of it by the true one; the two together may leave 0.02 more, 1.08."""
    whole = seen(items=[cause("base_tilt", {})], effect="base_tilt")
    names = ("encoder_offset", "link_length_error")
    for left, same in ((0.028, True), (0.032, False)):
        items = [cause(n, {}, left=left) for n in names]
        left_out = seen(effect="base_tilt", items=items, without=("base_tilt",))
        assert same_data(left_out, whole) == same
        assert answer_of(left_out, items[0], whole) == (None if same else "outside_library")
    far = {**cause("cogging", {}, left=0.001, ratio=60.0), "channel": "motor_mechanics/roll"}
    worse = seen(effect="base_tilt", items=[far, cause("tool_offset", {}, left=0.1)], without=("base_tilt",))
    assert not same_data(worse, whole)  # each place by itself: the larger gap elsewhere excuses nothing
    beside = seen(effect="base_tilt", items=[cause("tool_offset", {}), gap()], without=("base_tilt",))
    assert not same_data(beside, whole)  # a gap has no cause


def test_a_gap_that_only_the_effect_left_out_explains_is_of_that_effect():
    whole = seen(items=[cause("encoder_eccentricity", {})], effect="encoder_eccentricity")
    tip = gap("mechanism/tip", 4.0, 3.6)
    left_out = seen(effect="encoder_eccentricity", items=[cause("cogging"), tip], without=("encoder_eccentricity",))
    assert (
        answer_of(left_out, tip, replace(whole, places=("motor_mechanics/tilt", "mechanism/tip"))) == "outside_library"
    )
    echo = replace(whole, items=(*whole.items, tip), places=("motor_mechanics/tilt", "mechanism/tip"))
    assert answer_of(left_out, tip, echo) == "no_gap"


def test_what_is_found_where_no_fault_is_has_no_gap_of_its_own():
    healthy = seen("no_gap", items=[cause(), gap()])
    assert [answer_of(healthy, i, healthy) for i in healthy.items] == ["no_gap", "no_gap"]
    beside = seen(items=[cause(), gap("sensing/force_sensor")])
    assert answer_of(beside, beside.items[1], beside) == "no_gap"
    outside = seen("outside_library", "hum", items=[cause(), gap()], stage="drive")
    assert [answer_of(outside, i, outside) for i in outside.items] == ["outside_library", "outside_library"]


def test_every_plant_counts_the_same_once_it_has_ten_examples():
    """30 of one at 1 / 30 and 10 of the other at 1 / 10: each sums to 1, 40 examples weigh 40."""
    found = weights(30 * [Example("a", {}, "x")] + 10 * [Example("b", {}, "x")])
    assert found[[0, -1]] == pytest.approx([20 / 30, 20 / 10])
    assert weights([Example("a", {}, "x"), Example("a", {}, "y"), Example("b", {}, "x")]) == pytest.approx(np.ones(3))


def test_examples_of_an_answer_count_for_their_share():
    found = weights([Example("a", {}, "x"), Example("a", {}, "y"), Example("a", {}, "x")], {"y": 0.5})
    assert found == pytest.approx([1.2, 0.6, 1.2])
    rows = [("r", 0.0), ("o", 0.0), ("r", 1.0), ("o", 1.0)] * 100
    model = logistic([Example("a", {"x": x}, y) for y, x in rows], ("r", "o"), ("x",), {"o": 0.25})
    assert model.probabilities({"x": 0.5})["r"] == pytest.approx(0.8, abs=0.01)


def test_a_fit_by_hand():
    """Two cases in three right at x = 0, one in three at x = 1, hardly held down: odds of 2 and of 1 / 2."""
    rows = [(0, "r"), (0, "r"), (0, "o"), (1, "r"), (1, "o"), (1, "o")] * 50
    model = logistic([Example("a", {"x": float(x)}, y) for x, y in rows], ("r", "o"), ("x",))
    assert model.probabilities({"x": 0.0})["r"] == pytest.approx(2 / 3, abs=0.05)
    assert model.probabilities({"x": 1.0})["r"] == pytest.approx(1 / 3, abs=0.05)


def test_an_example_without_a_number_tells_nothing_of_it():
    rows = [({"x": 0.0, "y": 0.0}, "r"), ({"x": 1.0, "y": 1.0}, "o")] * 10
    lacking = [({"x": 0.5}, "r"), ({"x": 0.5}, "o")] * 50
    model = logistic([Example("a", n, y) for n, y in rows + lacking], ("r", "o"), ("x", "y"))
    assert model.middle == pytest.approx((0.5, 0.5))
    assert model.spread[1] == pytest.approx(0.5)  # of the twenty that have it
    assert model.probabilities({"x": 0.5})["r"] == pytest.approx(0.5, abs=1e-3)


def test_evidence_is_not_turned_round_by_chance():
    rows = [(0.0, "o"), (1.0, "r")] * 10
    model = logistic([Example("a", {"x": x}, y) for x, y in rows], ("r", "o"), ("x",))
    assert model.probabilities({"x": 1.0})["r"] == pytest.approx(model.probabilities({"x": 0.0})["r"], abs=1e-3)


def test_cases_of_one_kind_teach_nothing():
    with pytest.raises(ChallengeError, match="one kind"):
        logistic([Example("a", {"x": 1.0}, "r")] * 3, ("r", "o"), ("x",))


def test_a_conformal_reach_is_the_ceiling_of_n_plus_one_times_the_coverage():
    """Of 9 scores 0.9 * 10 = 9: the ninth; of 19 0.9 * 20 = 18: the eighteenth."""
    assert conformal([float(k) for k in range(1, 10)], 0.9) == 9.0
    assert conformal([float(k) for k in range(1, 20)], 0.9) == 18.0


def test_sharpness_by_hand():
    """True ones at distance 0 in two of three cases, at 1 in the third, both candidates at 0 and 1: exp(-s) = 1 / 2."""
    import math

    assert sharpness([(0.0, [0.0, 1.0]), (0.0, [0.0, 1.0]), (1.0, [0.0, 1.0])]) == pytest.approx(math.log(2.0), 1e-3)


def test_the_calibration_error_by_hand():
    """0.8 stated and met in 1 of 2, 0.2 stated and met in 1 of 2: errors of 0.3 in both bins."""
    answers = [(0.8, True), (0.8, False), (0.2, False), (0.2, True)]
    assert [(round(b.stated, 2), b.met, b.n) for b in bins(answers)] == [(0.2, 0.5, 2), (0.8, 0.5, 2)]
    assert calibration_error(answers) == pytest.approx(0.3)
    assert calibration_error([]) == 0.0


def plants(name):
    """A plant with clean true causes, imitations that leave half, foreign gaps, echoes of a gap, and healthy robots."""
    rows = []
    for k in range(6):
        rows.append(seen(items=[cause()], plant=name, case=f"{name}{k}"))
        rows.append(
            seen(items=[cause("cogging", {}, **BAD)], without=("coulomb_friction",), plant=name, case=f"{name}{k}")
        )
        rows.append(seen("outside_library", "hum", items=[gap()], stage="drive", plant=name, case=f"{name}o{k}"))
        rows.append(seen(items=[cause(), gap("drive/roll", 1.3, 3.0)], plant=name, case=f"{name}e{k}"))
        rows.append(seen("no_gap", items=[], plant=name, case=f"{name}h{k}"))
    return rows


def test_a_plant_left_out_is_judged_by_the_others():
    both = plants("a") + plants("b")
    judgements = held_out(both)["b"]
    assert len(judgements) == 30
    said = {j.seen.case[1:2] + str(bool(j.seen.without)): j.said for j in judgements}
    found = rates(judgements)
    assert found["balanced"].value == pytest.approx(1.0), said
    assert (found["withheld abstained"].value, found["withheld abstained"].n) == (1.0, 6)
    assert found["top1"].n == 12 and found["top1"].value == 1.0
    text = written({"b": found})
    assert "| withheld blamed | <= 0.05 | 0.00 [0.00, 0.39] (n 6) |" in text


def test_what_gives_the_same_data_is_in_the_set_however_well_the_cases_are_told_apart():
    told_apart = [
        replace(o, items=tuple(i | {"candidates": i["candidates"][:1]} for i in o.items)) for o in plants("a")
    ]
    found = calibrated(told_apart)
    assert found.reach >= found.same > 0.0


def test_a_calibration_survives_its_file(tmp_path):
    found = calibrated(plants("a"))
    path = tmp_path / "calibration.json"
    path.write_text(found.model_dump_json(by_alias=True))
    assert Calibration.read(path) == found
    assert [p.model_dump(exclude_none=True) for p in found.provenance] == [
        {"plant": "a", "cases": 24, "causes": 18, "gaps": 12}
    ]


def test_evidence_of_another_version_is_refused_by_name(tmp_path):
    file, row = tmp_path / "kept" / "1.json", seen(items=[cause()])
    assert stored(file) == []
    keep([row], file)
    assert stored(file) == [row]
    file.write_text(json.dumps({**json.loads(file.read_text()), "version": 8}))
    with pytest.raises(FileError, match=r"1\.json: holds evidence of another version.*value 8.*delete it"):
        stored(file)


def test_the_diagram_is_a_picture(tmp_path):
    given = {"a": [r for j in judged_by(calibrated(plants("a")), plants("a")) for r in j.right]}
    diagram(given, tmp_path / "reliability.png")
    assert (tmp_path / "reliability.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_labels_are_found_beside_the_runs_and_where_a_challenge_keeps_them(tmp_path):
    for case in ("cases/case_1", "own"):
        (tmp_path / case).mkdir(parents=True)
        (tmp_path / case / "case.yaml").write_text("")
    assert list(labelled(tmp_path)) == []
    (tmp_path / "labels").mkdir()
    withheld = {
        "status": "outside_library",
        "without": ["backlash"],
        "effects": [{"family": "outside", "withheld": "x"}],
    }
    (tmp_path / "labels/case_1.yaml").write_text(json.dumps(withheld))
    (tmp_path / "own/truth.yaml").write_text(json.dumps({"status": "no_gap", "effects": []}))
    assert [c.name for c in labelled(tmp_path)] == ["case_1", "own"]
    assert truth_of(tmp_path / "cases/case_1")["status"] == "attributed"
    assert truth_of(tmp_path / "cases/case_1")["effects"][0]["family"] == "x"


def test_the_provenance_says_how_imperfect_the_robots_were():
    shown = [
        replace(o, truth={**o.truth, "level": {"built": b, "shape": 0.1 * b}})
        for o, b in zip(plants("a"), (1, 2, 3), strict=False)
    ]
    assert ends(shown, "a", "built") == (1, min(3, len(shown))) and ends(plants("a"), "a", "shape") is None


def test_groups_of_levels_leave_out_what_has_none():
    level = {"built": 0.5, "shape": 0.05}
    known, unknown = replace(seen(), truth={**seen().truth, "level": level}), seen()
    assert {n: len(g) for n, g in groups([known, unknown], by_shape).items()} == {"bent laws": 1}
    assert {n: len(g) for n, g in groups([known, unknown], by_build).items()} == {"built well": 1}


def test_few_cases_hardly_move_the_weights_of_before_and_many_do():
    before = logistic([Example("a", {"x": float(x)}, y) for x, y in ((0, "r"), (1, "o"))] * 200, ("r", "o"), ("x",))
    turned = [Example("a", {"x": float(x)}, y) for x, y in ((0, "o"), (0, "o"), (0, "r"), (1, "o"))]
    told = [logistic(turned * n, ("r", "o"), ("x",), before=before).probabilities({"x": 0.0})["r"] for n in (1, 5, 200)]
    start = before.probabilities({"x": 0.0})["r"]
    assert start > told[0] > told[1] > told[2] and told[2] == pytest.approx(1 / 3, abs=0.05)


def test_a_calibration_that_is_updated_keeps_what_it_was_set_on():
    before = calibrated(plants("a"))
    found = updated(before, plants("b"))
    assert [p.plant for p in found.provenance] == ["a", "b"]
    assert (found.exact, found.sharpness, found.reach) == (before.exact, before.sharpness, before.reach)
    assert found.cause.middle == before.cause.middle and found.cause != before.cause
    same = placed_among(before, plants("b"))
    assert same.cause == before.cause and same.typical is not None
