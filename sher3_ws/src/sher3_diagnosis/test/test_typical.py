"""How unlike the labelled cases a cause is: distances by hand, and odds held back without a change of their order."""

import numpy as np
import pytest
from sher3_diagnosis.judge.calibration.logistic import Logistic
from sher3_diagnosis.judge.calibration.typical import LEAST_TRUST, RARE, RIDGE, Typical, distance, trust

MODEL = Logistic(
    classes=("library", "outside_library"), inputs=("x", "y"), middle=(1.0, 0.0), spread=(2.0, 1.0),
    weights=((1.0, 1.0), (0.0, 0.0)), offset=(0.0, 0.0),
)  # fmt: skip
ALIKE = ((1.0, 0.9), (0.9, 1.0))
"""Two inputs that mostly vary together."""


def test_a_distance_is_counted_per_input_that_is_there():
    """At (3, 0.5) of scales 2 and 1: (1, 0.5), squared over 1.05, halved; without y the first alone."""
    whole, plain = MODEL.scaled({"x": 3.0, "y": 0.5}), np.eye(2)
    assert distance(whole, plain) == pytest.approx(np.sqrt(1.25 / (1 + RIDGE) / 2))
    assert distance(MODEL.scaled({"x": 3.0}), plain) == pytest.approx(np.sqrt(1 / (1 + RIDGE)))
    assert distance(MODEL.scaled({}), plain) == 0.0


def test_numbers_that_do_not_go_together_are_unusual_though_neither_is_large():
    together, against = (MODEL.scaled({"x": 1.0 + 2.0 * x, "y": y}) for x, y in ((1.0, 1.0), (1.0, -1.0)))
    assert distance(against, np.array(ALIKE)) > 3.0 * distance(together, np.array(ALIKE))


@pytest.mark.parametrize(("far", "share"), [(0.5, 1.0), (1.5, 0.75), (2.5, 0.25), (9.0, 0.0)])
def test_typicality_is_the_share_that_is_at_least_as_far(far, share):
    """Quantiles 1, 2, 3 at 0, a half and 1."""
    known = Typical(covariance=((1.0, 0.0), (0.0, 1.0)), distances=(1.0, 2.0, 3.0), causes=3)
    assert known.typicality(MODEL, {"x": 1.0 + 2.0 * far * np.sqrt(1 + RIDGE)}) == pytest.approx(share)


def test_rare_evidence_weighs_less_and_turns_no_answer_round():
    assert trust(None) == trust(1.0) == trust(RARE) == 1.0 and trust(0.0) == LEAST_TRUST
    assert trust(0.5 * RARE) == pytest.approx((1.0 + LEAST_TRUST) / 2)
    numbers = {"x": 7.0, "y": 0.0}  # scores 3 and 0, held back 1.5 and 0
    assert MODEL.probabilities(numbers)["library"] == pytest.approx(1 / (1 + np.exp(-3.0)))
    assert MODEL.probabilities(numbers, LEAST_TRUST)["library"] == pytest.approx(1 / (1 + np.exp(-1.5)))
