"""The search over effects and shapes, and what an extension must be worth."""

import numpy as np
from sher3_diagnosis.attribute.candidates import Candidates, complexity, cost, price
from sher3_diagnosis.thresholds import PRICE
from toy import AXIS, DIRECTION, OFFSET, SPEED, Column, ToyRun, case, evidence_of


class Shaped(Column):
    """A quantity to a power that is searched: 1 first, then neighbours."""

    def shapes(self, views, site):
        return [{"power": 1.0}]

    def refine(self, shape):
        return [{"power": shape["power"] + step} for step in (-1.0, 1.0)]

    def signature(self, view, site, shape):
        found = super().signature(view, site, shape)
        return type(found)({c: np.sign(x) * np.abs(x) ** shape["power"] for c, x in found.columns.items()})


def test_the_best_effect_comes_first():
    evidence = evidence_of(case(5.0))
    found = Candidates(evidence, [OFFSET, DIRECTION, SPEED]).search([AXIS])
    assert found[0].terms[-1].effect is DIRECTION
    assert cost(found[0]) == found[0].total + PRICE


def test_an_effect_that_is_already_there_is_not_searched_again():
    evidence = evidence_of(case(5.0))
    candidates = Candidates(evidence, [DIRECTION])
    given = [candidates.term(DIRECTION, "axis", {})]
    assert candidates.search([AXIS], given) == []
    assert candidates.term(DIRECTION, "axis", {}) is given[0]


def test_an_effect_that_may_not_sit_there_or_is_impossible_is_not_found():
    evidence = evidence_of(case(-5.0))
    assert Candidates(evidence, [DIRECTION]).best(DIRECTION, "axis") is None  # its size would be negative
    elsewhere = Column("elsewhere", "friction", "direction", places=("tip",))
    assert Candidates(evidence_of(case(5.0)), [elsewhere]).search([AXIS]) == []


def test_a_shape_is_refined_around_the_best():
    """The truth is a cube: 1, then 2, then 3."""
    runs = [ToyRun(r.excitation, r.values + 30.0 * r.velocity**3, r.position, r.velocity) for r in case(0.0)]
    evidence = evidence_of(runs)
    effect = Shaped("cube", "friction", "velocity")
    found = Candidates(evidence, [effect]).best(effect, "axis")
    assert found.terms[-1].shape == {"power": 3.0}
    assert complexity(found.terms[-1]) == 2


def test_an_idle_extension_is_left_out_and_a_worthy_one_stays():
    wider = Column("wider", "friction", "direction", extends=("direction",))
    evidence = evidence_of(case(5.0))
    names = {f.terms[-1].effect.id for f in Candidates(evidence, [DIRECTION, wider]).search([AXIS])}
    assert names == {"direction"}
    speedy = Column("speedy", "friction", "velocity", extends=("offset",))
    evidence = evidence_of(case(5.0, "velocity"))
    names = {f.terms[-1].effect.id for f in Candidates(evidence, [OFFSET, speedy]).search([AXIS])}
    assert "speedy" in names


def test_a_number_costs_its_price():
    evidence = evidence_of(case(5.0))
    term = Candidates(evidence, [DIRECTION]).term(DIRECTION, "axis", {})
    assert price(term) == PRICE


class Counted(Shaped):
    """Counts how often its shapes are asked for."""

    asked = 0

    def shapes(self, views, site):
        type(self).asked += 1
        return super().shapes(views, site)


def test_an_effect_beside_the_same_causes_is_searched_once():
    """Beside other causes it is searched again."""
    effect = Counted("counted", "friction", "direction")
    candidates = Candidates(evidence_of(case(5.0)), [effect, OFFSET])
    offset = candidates.term(OFFSET, "axis", {})
    alone, beside = candidates.best(effect, "axis"), candidates.best(effect, "axis", [offset])
    times = effect.asked
    assert candidates.best(effect, "axis") is alone and candidates.best(effect, "axis", (offset,)) is beside
    assert len(beside.terms) == 2 and effect.asked == times == 2
