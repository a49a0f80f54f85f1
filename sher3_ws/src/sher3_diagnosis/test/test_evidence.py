"""What the evidence counts: repeats, samples, losses above the floor."""

import math
from dataclasses import replace

import numpy as np
import pytest
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import with_rivals
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.fit.fitting import fit
from sher3_diagnosis.fit.term import make_term
from sher3_diagnosis.judge.evidence.cause import cause_evidence
from toy import AXIS, DIRECTION, OFFSET, Column, ToyRun, case, evidence_of


def run(excitation, value):
    return ToyRun(excitation, np.full(4, value), np.zeros(4), np.ones(4))


def test_repeats_are_runs_beyond_the_first_of_each_excitation():
    assert evidence_of([run("a", 1.0), run("a", 1.0), run("b", 1.0)]).repeats == 1
    assert evidence_of([run("a", 1.0), run("b", 1.0)]).repeats == 0


def test_excess_is_the_loss_above_one_per_sample():
    evidence = evidence_of([run("a", 3.0), run("a", 1.0)])
    assert evidence.samples(AXIS) == 8
    assert evidence.excess(AXIS) == pytest.approx(4 * 9.0 + 4 * 1.0 - 8)
    assert evidence.excess(AXIS, evidence.null()) == pytest.approx(evidence.excess(AXIS))
    assert evidence.channels == [AXIS]


def test_angles_are_never_in_metres_and_torques_never_in_newtons():
    tip, sensor = Channel("mechanism", "tip"), Channel("sensing", "force_sensor")
    evidence = evidence_of([run("a", 1.0)], units={AXIS: "N", tip: "m", sensor: "N"})
    assert [evidence.unit(tip, i) for i in (0, 2, 3, 5)] == ["m", "m", "rad", "rad"]
    assert [evidence.unit(sensor, i) for i in (0, 5)] == ["N", "N*m"]
    assert (evidence.unit(AXIS), evidence.component(AXIS, 0)) == ("N", None)


def test_an_unknown_count_is_infinite():
    assert evidence_of([run("a", 1.0)], counts={"axis": 0.5}).count(AXIS) == 0.5
    assert math.isinf(evidence_of([run("a", 1.0)]).count(AXIS))


def test_two_causes_of_one_gap_share_what_they_leave():
    """Direction of 6 and an offset of 2 floors: the offset's part is 4 of 40 squares of the floor."""
    runs = [replace(r, values=r.values + 2.0) for r in case(6.0)]
    evidence = evidence_of(runs)
    terms = [make_term(evidence.data, effect, "axis", {}) for effect in (DIRECTION, OFFSET)]
    found = with_rivals(Candidates(evidence, [DIRECTION, OFFSET]), fit(evidence.data, terms))
    first, second = (cause_evidence(evidence, found, i) for i in found.causes)
    assert (first.part, second.part) == (pytest.approx(0.9, abs=0.02), pytest.approx(0.1, abs=0.02))
    assert first.left * first.part == pytest.approx(second.left * second.part)
    assert first.law is None  # the toy tells no quantities


def test_what_a_complete_law_leaves_beside_a_rough_one_may_be_the_rough_ones():
    rough = Column("direction", "friction", "direction", leaves_out="how it varies")
    evidence = evidence_of([replace(r, values=r.values + 2.0) for r in case(6.0)])
    for effects, idealised in (((DIRECTION, OFFSET), 0.0), ((rough, OFFSET), 1.0)):
        terms = [make_term(evidence.data, effect, "axis", {}) for effect in effects]
        found = with_rivals(Candidates(evidence, effects), fit(evidence.data, terms))
        assert [cause_evidence(evidence, found, i).idealised for i in found.causes] == [idealised] * 2
