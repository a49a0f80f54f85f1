"""Stepwise growth: every error that is worth its price, and none that is not."""

import numpy as np
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.stepwise import grow
from toy import DIRECTION, OFFSET, SPEED, ToyRun, case, evidence_of


def grown(runs):
    evidence = evidence_of(runs)
    effects = [OFFSET, DIRECTION, SPEED]
    return sorted(t.effect.id for t in grow(Candidates(evidence, effects), effects, evidence.null()).terms)


def test_small_errors_are_added_one_by_one():
    runs = [ToyRun(r.excitation, r.values + 0.6, r.position, r.velocity) for r in case(1.0)]
    assert grown(runs) == ["direction", "offset"]


def test_noise_is_worth_nothing():
    assert grown([ToyRun(r.excitation, np.asarray(r.values), r.position, r.velocity) for r in case(0.0)]) == []
