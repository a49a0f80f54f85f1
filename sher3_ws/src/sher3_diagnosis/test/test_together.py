"""Plain laws fitted at once, and what a cause must be worth."""

import math

import pytest
from sher3_diagnosis.attribute.together import worth_of
from sher3_diagnosis.thresholds import NEEDED, OF_THE_REST, PARSIMONY


class TermOfTwoNumbers:
    width, shape = 1, {"displacement": 1.0}


@pytest.mark.parametrize(
    ("explained", "left", "more"),
    [(1e6, math.inf, PARSIMONY * 1e6), (1e6, 1e3, OF_THE_REST * 1e3), (1e3, 1e6, PARSIMONY * 1e3)],
)
def test_a_cause_is_worth_its_numbers_and_a_share_of_what_laws_are_off_by(explained, left, more):
    assert worth_of(TermOfTwoNumbers(), explained, left) == pytest.approx(2.0 * NEEDED + more)
