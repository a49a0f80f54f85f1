"""Odds times costs: by hand, and monotone in every cost."""

import itertools

import pytest
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.finding import LIBRARY, NO_GAP, OUTSIDE, Candidate, Item, Judged
from sher3_diagnosis.judge.costs import DEFAULT, Costs, CostsError
from sher3_diagnosis.judge.status import answer_to, answer_to_exact, status_of
from sher3_diagnosis.verdict import Interval

CAUSE = Item(Channel("drive", "tilt"), 0, {}, [Candidate("drive_lag", "tilt", "timing", (), 0.0)])
GAP = Item(Channel("drive", "tilt"), None, {})
WHOLE = Interval(value=0.97, low=0.9, high=1.0)
SHARES = [i / 10 for i in range(11)]
LEVELS = (0.1, 0.3, 1.0, 3.0, 10.0)


def cause(library: float, outside: float) -> Judged:
    return Judged(CAUSE, (library,), outside, 1.0 - library - outside, WHOLE)


def test_where_all_mistakes_cost_the_same_the_most_probable_answer_is_given():
    assert [DEFAULT.cheapest(x) for x in ({LIBRARY: 0.6, OUTSIDE: 0.4}, {OUTSIDE: 0.6, NO_GAP: 0.4})] == [
        LIBRARY,
        OUTSIDE,
    ]


def test_a_wrong_name_of_three_needs_odds_of_three_to_one():
    """Naming costs 3 (1 - p) on average and abstaining p: even at p = 3 / 4."""
    dear = Costs(name=3.0)
    assert answer_to(cause(0.74, 0.26), dear) == OUTSIDE
    assert answer_to(cause(0.76, 0.24), dear) == LIBRARY
    assert answer_to_exact(0.74, dear) == OUTSIDE
    assert answer_to_exact(0.76, dear) == LIBRARY


def test_what_has_no_cause_is_never_named_however_cheap_a_name_is():
    assert answer_to(Judged(GAP, (), 0.6, 0.4), Costs(name=0.01)) == OUTSIDE
    assert answer_to_exact(0.0, Costs(name=0.01)) == OUTSIDE


@pytest.mark.parametrize("mistake, given", [("name", LIBRARY), ("abstain", OUTSIDE), ("miss", NO_GAP)])
def test_the_dearer_a_mistake_the_less_it_is_risked(mistake, given):
    for library, outside in itertools.product(SHARES, SHARES):
        if library + outside <= 1.0:
            said = [answer_to(cause(library, outside), Costs(**{mistake: c})) == given for c in LEVELS]
            assert said == sorted(said, reverse=True), (library, outside)


def test_the_status_is_monotone_too():
    """A likely cause beside a doubtful one: the dearer a wrong name, the sooner the verdict abstains."""
    both = [cause(0.95, 0.03), cause(0.55, 0.4)]
    found = [status_of(both, [], 0.5, Costs(name=c)) for c in LEVELS]
    assert found == ["attributed", "attributed", "attributed", "outside_library", "outside_library"]


def test_costs_are_read_and_slips_are_refused():
    assert Costs.parse("name=3,abstain=1") == Costs(name=3.0)
    assert Costs.parse("") == DEFAULT
    assert Costs.parse("miss=0.5").as_dict() == {"name": 1.0, "abstain": 1.0, "miss": 0.5}
    for wrong in ("naming=3", "name", "name=0", "name=-1", "name=inf", "name=x"):
        with pytest.raises(CostsError, match="no such cost"):
            Costs.parse(wrong)
