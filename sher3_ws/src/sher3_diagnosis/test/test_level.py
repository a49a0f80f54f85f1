"""The level of one machine: told by its other places, and the unit of what is left."""

import math

import numpy as np
import pytest
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.finding import Candidate, Item
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.judge.evidence.scales import LEAST_OWN, unexplained_share
from sher3_diagnosis.judge.level import LAWFUL, LEVELS, USUAL, at_level, lawful, level_weights
from sher3_diagnosis.judge.probabilities import judged, judged_together
from sher3_diagnosis.verdict import Interval

NUMBERS = {
    "left": 0.2, "part": 1.0, "spread": 0.01, "mismatch": 0.03, "ratio": 8.0, "power": 60.0, "idealised": 1.0,
}  # fmt: skip


def item(joint, **numbers):
    found = (Candidate("coulomb_friction", joint, "friction", (), 0.0),)
    return Item(Channel("motor_mechanics", joint), 0, NUMBERS | numbers, found)


def odds(*items):
    return [j.library for j in judged_together(items, [Interval(value=0.8)] * len(items), in_force(), True)]


def middle(weights):
    return math.exp(float(weights @ np.log(LEVELS)))


def test_a_place_alone_tells_no_level():
    assert level_weights([item("a"), item("a", left=0.01)])[0] == pytest.approx(np.ones(5) / 5)


def test_other_places_tell_the_level():
    well, badly = (level_weights([item("a"), *(item(j, left=left) for j in "bcd")])[0] for left in (0.005, 0.2))
    assert middle(well) < 0.01 and middle(badly) > 0.1


def test_a_bend_of_other_places_tells_the_level_as_what_is_strange_to_their_causes_does():
    strange, bent = (
        level_weights([item("a"), *(item(j, left=0.1, stray=stray) for j in "bcd")])[0] for stray in (0.1, 0.0)
    )
    assert bent == pytest.approx(strange)


def test_what_is_left_counts_in_units_of_the_level():
    assert at_level(NUMBERS, 10.0 * USUAL) == pytest.approx(NUMBERS | {"left": 0.025})  # a quarter of what laws explain
    beside = at_level(NUMBERS | {"part": 0.5}, 10.0 * USUAL)  # of all laws of the gap
    assert beside["left"] == pytest.approx(0.02 / 0.9)
    free = {"law": 0.1, "anything": 0.01}
    assert at_level(NUMBERS | free, 10.0 * USUAL).items() >= {("anything", 0.01)}  # whose law it follows has no level
    assert "law" not in at_level(NUMBERS | free, USUAL)  # and is asked once
    assert at_level(NUMBERS, 0.003) == at_level(NUMBERS, USUAL)  # none is better than the labelled robots


def test_half_of_a_gap_is_all_the_power_of_its_laws_which_no_level_expects():
    assert at_level(NUMBERS | {"left": 0.5}, USUAL)["left"] == pytest.approx(1.0)
    (half,) = odds(item("a", left=0.5))
    assert half < 0.3  # 0.40 where half of a gap counts as half of what the laws do


def test_twenty_per_cent_are_right_on_a_machine_that_leaves_them_everywhere_and_not_on_a_good_one():
    bad, good = odds(item("a"), *(item(j) for j in "bcd"))[0], odds(item("a"), *(item(j, left=0.003) for j in "bcd"))[0]
    assert good == pytest.approx(judged(item("a"), in_force()).library, abs=0.1)
    assert bad > good + 0.2


def test_the_odds_over_all_levels_add_up_to_one():
    for j in judged_together([item("a"), item("b")], [Interval(value=0.8)] * 2, in_force(), True):
        assert sum(j.odds.values()) == pytest.approx(1.0)
        assert j.item.numbers["left"] == 0.2


@pytest.mark.parametrize("others", [False, True])
@pytest.mark.parametrize("missed", [1.0, 0.5, 0.1])
def test_the_less_of_what_is_left_no_function_explains_the_likelier_is_a_foreign_law(missed, others):
    def odds_of(**told):
        (found,) = judged_together([item("a", **told)], [Interval(value=0.8)], in_force(), True)
        return found.outside / found.library

    exponent, even = LAWFUL
    free = {"law": 0.2 if others else 0.2 * missed, "anything": 0.2 * missed}  # of 0.2 that are left
    shares = missed * (missed if others else 1.0)  # what other inputs explain counts in both questions
    assert odds_of(**free) == pytest.approx(odds_of() * (even**2 / shares) ** exponent)
    assert lawful(NUMBERS) == 1.0  # where nothing was looked at


def test_what_is_left_below_the_floor_is_no_function():
    """A remainder of 0.01 of the floor's power: what is explained of it is a hundredth at most."""
    small = NUMBERS | {"left": 0.01, "power": 1.0, "law": 0.01, "anything": 0.0}
    assert unexplained_share(small) == pytest.approx(0.99)
    assert unexplained_share(small | {"power": 1e4}) == LEAST_OWN
