"""Where a gap lives against where its cause says it does."""

import pytest
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.localise.pattern import pattern_of
from toy import DIRECTION, SPEED, case, evidence_of


def agreement(effect):
    evidence = evidence_of(case(5.0))
    return pattern_of(evidence, Candidates(evidence, [effect]).best(effect, "axis"), 0)


def test_the_gap_of_a_true_cause_lives_where_it_predicts():
    found = agreement(DIRECTION)
    assert found.agreement > 0.95
    assert {"speed", "direction", "phase", "excitation"} <= set(found.mismatch)


def test_a_stand_in_takes_its_loss_off_in_other_places():
    found = agreement(SPEED)
    assert found.agreement < agreement(DIRECTION).agreement
    assert found.worst is not None


def test_the_shares_of_a_family_add_up_to_one():
    shares = [s for s in agreement(DIRECTION).shares if s.family == "speed"]
    assert sum(s.predicted for s in shares) == pytest.approx(1.0)
    assert sum(s.realised for s in shares) == pytest.approx(1.0)
