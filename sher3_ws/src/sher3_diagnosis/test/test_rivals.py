"""Rivals: what would explain as much in a cause's place."""

from dataclasses import replace

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import with_rivals, without_term
from sher3_diagnosis.channel import Channel
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


def test_a_cause_is_compared_where_it_was_ranked():
    """What other places leave is in the loss of the whole fit, and would make every rival the better one."""
    found = rivals([DIRECTION, TWIN, SPEED, OFFSET])
    ranking, own = found.ranked(0)
    whole = replace(found, fit=replace(found.fit, loss={**found.fit.loss, (0, Channel("drive", "other")): 1e6}))
    assert whole.fit.total > own + 1e5
    assert whole.ranked(0) == (ranking, own)
    assert own == min(f.total for f in ranking if f.terms[-1].key == found.fit.terms[0].key)


def test_a_term_can_be_left_out():
    evidence = evidence_of(case(5.0))
    fit = Candidates(evidence, [DIRECTION]).best(DIRECTION, "axis")
    assert without_term(evidence, fit, 0).terms == ()
    assert AXIS in fit.terms[0].channels
