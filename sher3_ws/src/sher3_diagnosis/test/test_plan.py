"""The one search follows what a plan declares."""

from dataclasses import replace
from functools import partial

import pytest
from sher3_diagnosis.attribute.candidates import Candidates, possible
from sher3_diagnosis.attribute.plan import Opening, SearchPlan
from sher3_diagnosis.attribute.planned import planned
from sher3_diagnosis.judge.left_over import down_to_floor
from toy import AXIS, DIRECTION, OFFSET, SPEED, Column, ToyRun, case, evidence_of

BOTH = [ToyRun(r.excitation, r.values + 4.0, r.position, r.velocity) for r in case(5.0)]
HIDDEN = Column("hidden", "friction", "direction", unseen=True)


def names(plan, effects=(OFFSET, DIRECTION, SPEED), runs=BOTH):
    evidence = evidence_of(runs)
    left = partial(down_to_floor, [AXIS], evidence)
    found = planned(Candidates(evidence, list(effects)), plan, left, lambda _: None)
    return [t.effect.id for t in found.fit.terms]


def first(name):
    """Return an order that begins with one effect."""
    return lambda _, trials, given: trials if given else [x for x in trials if x.terms[-1].effect.id == name]


def no_offset(trial):
    return trial.terms[-1].effect.id != "offset" and possible(trial)


@pytest.mark.parametrize(
    ("plan", "expected"),
    [
        (SearchPlan(), ["direction", "offset"]),
        (SearchPlan(order=first("offset")), ["offset", "direction"]),
        (SearchPlan(causes=1), ["direction"]),
        (SearchPlan(possible=no_offset), ["direction"]),
        (SearchPlan(reviews=(lambda evidence, found: found.kept(evidence, [1]),)), ["offset"]),
    ],
)
def test_order_limits_and_reviews_are_those_of_the_plan(plan, expected):
    assert names(plan) == expected


def test_plain_laws_are_fitted_at_once_or_grown_layer_by_layer():
    plain = [Column(e.id, e.family, e.quantity, plain=True) for e in (OFFSET, DIRECTION)]
    assert sorted(names(SearchPlan(together=True), plain)) == ["direction", "offset"]
    assert sorted(names(SearchPlan(layers=True), [plain[0], DIRECTION])) == ["direction", "offset"]


def test_one_cause_that_closes_the_gap_with_its_best_shape_has_no_second():
    asked = []
    plan = SearchPlan(single=lambda evidence, found: asked.append(len(found.causes)) or found)
    assert names(plan, runs=case(5.0)) == ["direction"] and asked == [1]
    assert names(plan) == ["direction", "offset"]


def test_an_opening_is_taken_where_it_is_better_by_the_share_it_asks_for():
    """Without an opening nothing hidden is named. Alone it leaves 16 floors a sample, the offset 25: a third less."""
    opening = Opening(first("hidden"), tried=lambda candidates, found: True, worth=0.2, unseen=True)

    def of(opening):
        return names(SearchPlan(causes=1, openings=(opening,)), (OFFSET, HIDDEN))

    assert names(SearchPlan(causes=1), (OFFSET, HIDDEN)) == ["offset"]
    assert of(opening) == ["hidden"]
    assert of(replace(opening, worth=0.5)) == ["offset"]
    assert of(replace(opening, tried=lambda candidates, found: False)) == ["offset"]


def test_what_no_residual_holds_counts_beyond_the_residuals():
    """The offset is held against at rest: a fit with it costs more than all that it explains."""
    opening = Opening(first("direction"), tried=lambda candidates, found: True)
    plan = SearchPlan(causes=1, order=first("offset"), openings=(opening,))
    at_rest = {"offset": 0.0, "direction": 1e9}
    held = replace(plan, beyond=lambda evidence, found: at_rest[found.terms[0].effect.id])
    assert names(plan) == ["direction"] and names(held) == ["offset"]
