"""Causes that say nothing, by hand: of no size, wider than the travel, of no use to what was left out."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import with_rivals
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.fit.fitting import fit, make_term
from sher3_diagnosis.judge.items import items_of
from sher3_diagnosis.judge.meaning import (
    OPEN,
    linear_in,
    may_be_zero,
    open_sizes,
    says_nothing,
    sizes_of,
    without_empty,
    without_open_sizes,
)
from sher3_diagnosis.localise.gaps import localise
from sher3_diagnosis.verdict import Cause, Interval, Parameter
from toy import DIRECTION, Column, case, evidence_of


class Law(Column):
    """A size, its inverse, and a place that does not depend on how much of the law there is."""

    def parameters(self, shape, coefficients):
        a, b = map(float, coefficients)
        return {"size": a, "inverse": 1.0 / a, "place": b / a, "shape": 3.0}


class Term:
    """What of a term is asked here."""

    def __init__(self, effect):
        self.effect, self.shape, self.site, self.fixed = effect, {}, "axis", []


def cause(closure=(0.9, 0.8), **parameters):
    told = {n: Parameter(value=0.5 * (a + b), low=a, high=b, unit="N") for n, (a, b) in parameters.items()}
    shrinks = Interval(value=closure[0], low=closure[1], high=1.0)
    return Cause(effect="x", family="y", stage="z", actuator="axis", parameters=told, closure=shrinks)


def nothing_left(fit):
    """No gap is open under any fit."""
    return ()


IDLE = cause(closure=(0.1, -0.1), size=(1.0, 2.0))
"""A cause that may be of no use to what was left out."""
PARTED = [(-1.0) ** i * np.sign(run.velocity) for i, run in enumerate(case(4.0))]
"""A quantity that goes with the direction in every second run, against it in the others."""


def test_sizes_are_what_all_coefficients_scale():
    term, found = Term(Law("law", "spring", "one")), np.array([2.0, 4.0])
    assert sizes_of(term, found) == ["size", "inverse"]
    assert linear_in(term, found) == ["size"]


def test_a_shape_that_does_something_by_itself_has_sizes_where_its_coefficients_are_none():
    """A dead time before a lag: it stays where the lag may be none."""
    term, found = Term(Law("law", "spring", "one")), np.array([2.0, 4.0])
    term.fixed = [{"channel": np.ones(3)}]
    assert sizes_of(term, found) == ["size", "inverse", "place", "shape"]
    told = cause(size=(-1.0, 2.0), inverse=(-1.0, 2.0), place=(-1.0, 2.0), shape=(2.0, 4.0))
    assert not may_be_zero(term, found, told)
    assert may_be_zero(Term(Law("law", "spring", "one")), found, told)


def test_an_effect_that_is_there_by_a_choice_has_no_size():
    term = Term(Law("law", "spring", "one", discrete=frozenset({"shape"})))
    term.fixed = [{"channel": np.ones(3)}]
    assert sizes_of(term, np.array([2.0, 4.0])) == []


def test_a_cause_whose_sizes_hold_zero_has_none():
    term, found = Term(Law("law", "spring", "one")), np.array([2.0, 4.0])
    assert may_be_zero(term, found, cause(size=(-1.0, 3.0), place=(1.0, 2.0)))
    assert not may_be_zero(term, found, cause(size=(1.0, 3.0), place=(-1.0, 2.0)))


@pytest.mark.parametrize("least", [-1.0, 1.0])
def test_what_tells_a_law_from_a_simpler_one_must_not_hold_zero(least):
    evidence = evidence_of(case(6.0))
    effect = Column("rich", "friction", "direction", extends_by=("place",))
    found = fit(evidence.data, [make_term(evidence.data, effect, "axis", {})])
    assert says_nothing(evidence, found, 0, cause(size=(1.0, 3.0), place=(least, 2.0))) is (least < 0.0)


@pytest.mark.parametrize(
    ("told", "empty"),
    [
        (cause(size=(1.0, 1.5)), False),
        (cause(size=(1.0, 1.5), closure=(0.1, -0.1)), True),  # may be of no use to parts left out
        (cause(size=(1.0, 1.5), closure=(-0.1, -0.3)), True),  # makes them worse
        (cause(size=(1.0, 2.5)), True),  # the travel is 2 m
    ],
)
def test_a_lost_motion_is_no_wider_than_the_travel_and_shrinks_what_was_left_out(told, empty):
    evidence = evidence_of(case(6.0))
    gap = Column("gap", "lost_motion", "direction", units={"size": "m"})
    found = fit(evidence.data, [make_term(evidence.data, gap, "axis", {})])
    assert says_nothing(evidence, found, 0, told) is empty


@pytest.mark.parametrize(("end", "unit", "empty"), [(1.5, "rad", False), (2.5, "rad", True), (2.5, "N", False)])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_size_in_the_unit_of_a_place_is_no_larger_than_the_travel(end, unit, empty, sense):
    """What a servo sags under its weight, of whatever family: the travel is 2 m."""
    evidence = evidence_of(case(6.0))
    found = fit(evidence.data, [make_term(evidence.data, Column("sag", "load", "direction"), "axis", {})])
    (name,) = linear_in(found.terms[0], found.of(0))
    told = cause(**{name: tuple(sorted((sense, sense * end)))})
    told.parameters[name] = told.parameters[name].model_copy(update={"unit": unit})
    assert says_nothing(evidence, found, 0, told) is empty


def test_a_law_that_is_no_more_than_a_simpler_one_becomes_that_one_and_others_go():
    rich = Column("rich", "friction", "direction", extends=("direction",))
    evidence = evidence_of(case(6.0))
    candidates = Candidates(evidence, [DIRECTION, rich])
    found = with_rivals(candidates, fit(evidence.data, [make_term(evidence.data, rich, "axis", {})]))
    kept = without_empty(candidates, found, [cause(size=(1.0, 2.0))], nothing_left)
    assert kept is found
    plain = without_empty(candidates, found, [IDLE], nothing_left)
    assert [t.effect.id for t in plain.fit.terms] == ["direction"]
    none = without_empty(candidates, plain, [IDLE], nothing_left)
    assert none.fit.terms == () and none.rivals == ()


def test_what_has_no_size_may_stay_in_the_fit_without_a_name():
    """Where every part has a small error of its own: nothing of the fit changes, and the others keep their sizes."""
    evidence = evidence_of(case(6.0))
    second = Column("second", "friction", "one")
    candidates = Candidates(evidence, [DIRECTION, second])
    terms = [make_term(evidence.data, effect, "axis", {}) for effect in (DIRECTION, second)]
    found = with_rivals(candidates, fit(evidence.data, terms))
    told = [cause(size=(1.0, 2.0)), cause(size=(-1.0, 2.0))]
    kept = without_empty(candidates, found, told, nothing_left, carried=True)
    assert [kept.fit.terms[i].effect for i in kept.causes] == [DIRECTION]
    assert kept.nuisance == 1 and kept.fit.total == pytest.approx(found.fit.total)
    assert kept.explained == (found.explained[1], found.explained[0])
    gone = without_empty(candidates, found, told, nothing_left)
    assert [t.effect for t in gone.fit.terms] == [DIRECTION]
    needed = without_empty(candidates, found, told, lambda fit: () if len(fit.terms) > 1 else evidence.channels)
    assert needed is found  # a gap opens without it


def test_what_explains_most_of_its_place_stays_whatever_its_size():
    """How large it is, is open; that it is there is not."""
    runs = [replace(run, values=run.values + 15.0 * x, warmth=x) for run, x in zip(case(4.0), PARTED, strict=True)]
    evidence = evidence_of(runs)
    second = Column("second", "inertia", "warmth")
    candidates = Candidates(evidence, [DIRECTION, second])
    terms = [make_term(evidence.data, effect, "axis", {}) for effect in (DIRECTION, second)]
    found = with_rivals(candidates, fit(evidence.data, terms))
    small = max(found.causes, key=lambda i: found.explained[i])
    told = [cause(size=(-1.0, 2.0) if i == small else (1.0, 2.0)) for i in found.causes]
    assert without_empty(candidates, found, told, nothing_left) is found


def test_a_gap_that_only_nameless_terms_explain_is_still_a_gap():
    """The verdict was «no gap» where small errors of all parts, none of them sure, took most of one."""
    evidence = evidence_of(case(6.0))
    candidates = Candidates(evidence, [DIRECTION])
    found = with_rivals(candidates, fit(evidence.data, [make_term(evidence.data, DIRECTION, "axis", {})]))
    kept = without_empty(candidates, found, [cause(size=(-1.0, 2.0))], nothing_left, carried=True)
    (item,) = items_of(Finding(evidence, localise(evidence), kept, [], {}))
    assert item.index is None


@pytest.mark.parametrize(
    ("interval", "means"),
    [((0.057, 1.6), OPEN), ((-1.6, -0.057), OPEN), ((0.4, 3.6), None), ((-0.1, 3.0), f"{OPEN}, at most 3 N")],
)
def test_a_size_of_no_known_order_is_told_without_its_number_and_with_what_would_tell_it(interval, means):
    """Of one that may be zero the most is told alone: that the cause is there is told by what it closes."""
    evidence = evidence_of(case(6.0))
    candidates = Candidates(evidence, [DIRECTION])
    found = with_rivals(candidates, fit(evidence.data, [make_term(evidence.data, DIRECTION, "axis", {})]))
    told = without_open_sizes(found, [cause(size=interval)])
    size = told[0].parameters["size"]
    assert (size.low, size.high) == ((None, None) if interval[0] * interval[1] < 0.0 else interval)
    assert size.means == means
    notes = open_sizes(found, told)
    assert len(notes) == (means is not None) and all(n.endswith("what would tell it: steps show it") for n in notes)


def test_a_law_that_closes_nothing_gives_its_place_to_a_rival_that_explains_as_much():
    other = Column("other", "spring", "direction")
    evidence = evidence_of(case(6.0))
    candidates = Candidates(evidence, [DIRECTION, other])
    found = with_rivals(candidates, fit(evidence.data, [make_term(evidence.data, other, "axis", {})]))
    kept = without_empty(candidates, found, [IDLE], nothing_left)
    assert [t.effect.id for t in kept.fit.terms] == ["direction"]
