"""Forward selection, pairs, the backward pass, and stopping."""

from functools import partial

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.search import attribute
from sher3_diagnosis.judge.left_over import left_over
from toy import AXIS, DIRECTION, OFFSET, SPEED, Column, ToyRun, case, evidence_of


def found(runs, effects=(OFFSET, DIRECTION, SPEED)):
    evidence = evidence_of(runs)
    said = []
    result = attribute(Candidates(evidence, list(effects)), partial(left_over, [AXIS], evidence), said.append)
    return [t.effect.id for t in result.fit.terms], result, said


def test_one_cause_is_enough_where_one_explains_the_gap():
    names, result, said = found(case(5.0))
    assert names == ["direction"]
    assert said == ["explaining motor_mechanics/axis"]
    assert result.causes == range(1)


def test_two_causes_are_found_where_two_are_at_work():
    both = [ToyRun(r.excitation, r.values + 4.0, r.position, r.velocity) for r in case(5.0)]
    names, _, _ = found(both)
    assert sorted(names) == ["direction", "offset"]


def test_a_twentieth_left_by_a_law_that_machines_follow_is_another_cause():
    """A friction of 20 floors beside an offset of 5 leaves a 17th of the gap: the bend of its law, or another cause."""
    both = [ToyRun(r.excitation, r.values + 5.0, r.position, r.velocity) for r in case(20.0)]
    rough = Column("direction", "friction", "direction", leaves_out="how it varies")
    assert found(both, (OFFSET, DIRECTION))[0] == ["direction", "offset"]
    assert found(both, (OFFSET, rough))[0] == ["direction"]


def test_no_cause_is_named_without_a_gap_or_an_effect_that_explains_it():
    assert found(case(0.0))[0] == []
    assert found(case(5.0), effects=(OFFSET,))[0] == []


def test_what_each_cause_explains_is_the_loss_its_removal_adds():
    _, result, _ = found(case(5.0))
    evidence = evidence_of(case(5.0))
    worth = sum(evidence.data.null_loss.values()) - result.fit.total
    assert abs(result.explained[0] - worth) < 1e-6 * worth
