"""Rivals: what would explain as much in a cause's place."""

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import with_rivals, without_term
from toy import AXIS, DIRECTION, OFFSET, SPEED, Column, case, evidence_of

TWIN = Column("twin", "friction", "direction")


def rivals(effects):
    evidence = evidence_of(case(5.0))
    candidates = Candidates(evidence, effects)
    return with_rivals(candidates, candidates.best(DIRECTION, "axis"))


def test_a_twin_is_a_rival_and_a_worse_effect_is_not():
    found = rivals([DIRECTION, TWIN, SPEED, OFFSET])
    assert [f.terms[-1].effect.id for f in found.rivals[0]] == ["twin"]
    assert {f.terms[-1].effect.id for f in found.ranking[0]} >= {"direction", "twin", "speed"}


def test_a_term_can_be_left_out():
    evidence = evidence_of(case(5.0))
    fit = Candidates(evidence, [DIRECTION]).best(DIRECTION, "axis")
    assert without_term(evidence, fit, 0).terms == ()
    assert AXIS in fit.terms[0].channels
