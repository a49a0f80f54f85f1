"""Probabilities from plain numbers, worked out by hand; the file that the package carries."""

import math

import pytest
from pydantic import ValidationError
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.finding import Candidate, Item, Judged
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.judge.calibration.logistic import Logistic
from sher3_diagnosis.judge.costs import DEFAULT
from sher3_diagnosis.judge.evidence.scales import scaled_cause, scaled_exact, scaled_gap
from sher3_diagnosis.judge.probabilities import judged
from sher3_diagnosis.judge.status import answer_to, combined, crosses
from sher3_diagnosis.verdict import Interval

TWO = {"classes": ("library", "outside_library"), "inputs": ("x",), "middle": (1.0,), "spread": (2.0,)}
NUMBERS = {
    "left": 0.01, "law": 0.01, "place": 0.01, "anything": 0.01, "spread": 0.001,
    "mismatch": 0.02, "ratio": 6.0, "power": 36.0, "idealised": 1.0,
}  # fmt: skip
CALIBRATION = in_force()


def cause(**changes: float) -> Item:
    candidates = [
        Candidate("coulomb_friction", "tilt", "friction", (), 0.0),
        Candidate("payload_mass", "tilt", "inertia", (), 0.2),
    ]
    return Item(Channel("motor_mechanics", "tilt"), 0, NUMBERS | changes, candidates)


def test_a_logistic_model_by_hand():
    """Score 3 * (5 - 1) / 2 = 6 and 0, less 6: two even odds; at x = 3 the scores are -3 and 0."""
    model = Logistic(**TWO, weights=((3.0,), (0.0,)), offset=(-6.0, 0.0))
    assert model.probabilities({"x": 5.0}) == pytest.approx({"library": 0.5, "outside_library": 0.5})
    assert model.probabilities({"x": 3.0})["library"] == pytest.approx(1.0 / (1.0 + math.exp(3.0)))


def test_what_is_not_known_speaks_neither_way():
    """At its middle a number adds nothing: the scores are the offsets, -6 and 0."""
    model = Logistic(**TWO, weights=((3.0,), (0.0,)), offset=(-6.0, 0.0))
    assert model.probabilities({})["library"] == pytest.approx(1.0 / (1.0 + math.exp(6.0)))
    limit = {name: x for name, x in NUMBERS.items() if name != "spread"}  # it has no coefficient
    assert "spread" not in scaled_cause(limit)
    assert "foreign" not in scaled_cause({n: x for n, x in NUMBERS.items() if n not in ("law", "place", "anything")})


def test_a_model_whose_numbers_do_not_fit_is_refused():
    with pytest.raises(ValidationError, match="differ in number"):
        Logistic(**TWO, weights=((3.0, 1.0), (0.0,)), offset=(0.0, 0.0))


def test_scales_end_where_they_tell_nothing_more():
    nothing = scaled_cause(NUMBERS | {"left": -0.2, "law": 0.1, "anything": 0.04})
    assert nothing["left"] == pytest.approx(math.log(0.003))
    assert nothing["floors"] == pytest.approx(math.log(0.3))
    assert nothing["foreign"] == nothing["complete"] == 0.0  # what is not left is nobody's
    numbers = NUMBERS | {"left": 0.1, "law": 0.1, "anything": 0.04}
    assert scaled_cause(numbers)["foreign"] == pytest.approx(-math.log(0.4))  # others explain 0.6 of what is left
    small = scaled_cause(numbers | {"left": 0.01, "law": 0.01, "anything": 0.0})
    assert small["foreign"] == pytest.approx(-math.log(1.0 - 0.007 * 6.0**2))  # of a floor, of which it is a quarter
    assert scaled_cause(numbers | {"law": 0.3, "anything": 0.0})["foreign"] == pytest.approx(math.log(50.0))  # all


def test_a_bend_of_the_law_is_its_own_whoever_tells_where_it_bends():
    numbers = NUMBERS | {"left": 0.1, "law": 0.1, "anything": 0.04}
    assert scaled_cause(numbers | {"stray": 0.0})["foreign"] == pytest.approx(-math.log(1.0 - 0.6 * 0.5))
    assert scaled_cause(numbers | {"stray": 0.1})["foreign"] == scaled_cause(numbers)["foreign"]


def test_what_is_too_little_to_be_a_remainder_is_nobodys():
    bare = NUMBERS | {"left": 0.0025, "law": 0.0025, "anything": 0.0, "power": 1e4}
    assert scaled_cause(bare)["foreign"] == 0.0
    assert scaled_cause(NUMBERS | {"left": 0.1})["floors"] == pytest.approx(math.log(0.1 * 6.0**2))  # six floors
    complete = scaled_cause(NUMBERS | {"left": 0.03, "idealised": 0.0})
    assert complete["complete"] == pytest.approx(math.log(10.0))  # ten times the share that is nothing
    assert scaled_gap({"power": 0.5, "ratio": 1.0, "beside": -2.0}) == {"power": 0.0, "alone": 0.0}
    assert scaled_gap({"power": 500.0, "beside": 0.0})["power"] == pytest.approx(math.log(10.0))
    assert scaled_exact(0.9) == {"missed": pytest.approx(0.1)}


def test_a_remainder_is_the_bends_of_all_causes_or_one_foreign_law():
    """16 % of a part that is 1 % of the gap: 0.16 % of the whole, and three quarters of the way there 0.5 %."""
    alone, beside = (scaled_cause(NUMBERS | {"left": 0.16, "part": part}) for part in (1.0, 0.01))
    assert alone["left"] == pytest.approx(math.log(0.16)) == scaled_cause(NUMBERS | {"left": 0.16})["left"]
    assert beside["left"] == pytest.approx(math.log(0.16 * 0.01**0.75))
    assert beside["floors"] == alone["floors"]  # as much of it, however many causes there are
    assert answer_to(judged(cause(part=0.01), CALIBRATION, Interval(value=0.4, low=0.3)), DEFAULT) == "library"


def test_a_gap_beyond_doubt_is_not_unusual_for_its_size():
    assert scaled_cause(NUMBERS | {"ratio": 400.0})["size"] == pytest.approx(math.log(25.0))


def test_candidates_share_what_the_library_has_by_their_unlikeness():
    j = judged(cause(), CALIBRATION)
    assert sum(j.effects) + j.outside + j.no_gap == pytest.approx(1.0)
    assert j.effects[1] / j.effects[0] == pytest.approx(math.exp(-0.2 * CALIBRATION.sharpness))


def test_a_clean_cause_is_named_and_one_that_leaves_half_to_foreign_inputs_is_not():
    assert answer_to(judged(cause(), CALIBRATION, Interval(value=0.99)), DEFAULT) == "library"
    worse = cause(left=0.6, law=0.5, place=0.5, anything=0.1, spread=0.2, mismatch=0.5)
    assert answer_to(judged(worse, CALIBRATION, Interval(value=0.99)), DEFAULT) == "outside_library"


def test_a_great_gap_without_a_cause_is_outside():
    gap = Item(Channel("drive", "tilt"), None, {"power": 50.0, "ratio": 7.0, "beside": 0.0, "others": 0.0})
    assert answer_to(judged(gap, CALIBRATION), DEFAULT) == "outside_library"


def test_a_cause_whose_closure_may_be_nothing_is_not_named():
    def said(**closure: float) -> str:
        return answer_to(judged(cause(), CALIBRATION, Interval(**closure)), DEFAULT)

    assert said(value=0.5, low=0.3) == said(value=0.5) == "library"
    assert said(value=0.5, low=-0.1) == "outside_library"
    assert said(value=0.4, low=0.3) == "outside_library"  # most of the gap is left
    assert said(value=0.0) == "no_gap"  # over all runs there is nothing above the floor
    assert judged(cause(), CALIBRATION, Interval(value=0.0)).no_gap == 1.0


def test_of_a_cause_that_is_not_named_the_more_probable_of_the_other_answers_holds():
    sure, unsure = (Judged(cause(), (0.6,), 0.1, 0.3, Interval(value=0.9, low=low)) for low in (0.5, -0.1))
    assert answer_to(sure, DEFAULT) == "library"
    assert answer_to(unsure, DEFAULT) == "no_gap"


def test_the_status_follows_from_the_answers():
    assert combined([], False) == "no_gap"
    assert combined(["no_gap"], True) == "no_gap"
    assert combined(["library", "no_gap"], False) == "attributed"
    assert combined(["library"], True) == "under_excited"
    assert combined(["library", "outside_library"], True) == "outside_library"


def test_only_another_family_that_gives_the_same_data_makes_runs_poor():
    assert crosses(cause(), same=0.3)
    assert not crosses(cause(), same=0.1)


def test_the_calibration_says_what_it_was_set_on():
    assert {p.plant for p in CALIBRATION.provenance}
    assert all(p.cases > 0 for p in CALIBRATION.provenance)
    assert CALIBRATION.coverage >= 0.95
