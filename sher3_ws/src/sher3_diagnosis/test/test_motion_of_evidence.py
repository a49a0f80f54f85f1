"""The level of a friction from the samples in motion, by hand."""

import numpy as np
import pytest
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Signature
from sher3_diagnosis.fit.fitting import fit, make_term
from sher3_diagnosis.quantify.motion import in_motion
from sher3_diagnosis.quantify.parameters import parameters
from toy import AXIS, Column, ToyRun, evidence_of


class Rubbing(Column):
    """A force against the motion, and against the last one at rest, where it may be any force up to its size."""

    settles = True

    def signature(self, view, site, shape):
        value = np.where(view.run.velocity == 0.0, 1.0, np.sign(view.run.velocity))
        return Signature({Channel(self.stage, site): value[:, None, None]})

    def held(self, view, site, shape, coefficients):
        return np.where(view.run.velocity == 0.0, abs(float(coefficients[0])), 0.0)


RUBBING = Rubbing("rubbing", "friction", "direction")


def found(values, velocity, effect=RUBBING):
    runs = [ToyRun("a", np.array(values), np.zeros(len(values)), np.array(velocity)) for _ in range(5)]
    evidence = evidence_of(runs, floor=0.5)
    return evidence, fit(evidence.data, [make_term(evidence.data, effect, "axis", {})])


def test_what_is_held_at_rest_does_not_pull_the_level_down():
    """Moving takes 3 N both ways, resting with 1 N twice: all samples say (3 + 3 + 1 + 1) / 4 = 2 N."""
    evidence, whole = found([3.0, -3.0, 1.0, 1.0], [1.0, -1.0, 0.0, 0.0])
    assert whole.of(0) == pytest.approx([2.0])
    moving = in_motion(evidence, whole)
    assert moving.fit.of(0) == pytest.approx([3.0])
    assert moving.whole.of(0) == pytest.approx([3.0])
    assert moving.whole.loss == whole.loss
    assert [len(t[AXIS]) for t in moving.evidence.data.target] == [2] * 5
    assert parameters(moving.evidence, moving.fit, 0)["size"].value == pytest.approx(3.0)


def test_all_samples_count_where_nothing_rests_or_hardly_anything_moves():
    assert in_motion(*found([3.0, -3.0], [1.0, -1.0])) is None
    assert in_motion(*found([3.0, 1.0, 1.0, 1.0], [1.0, 0.0, 0.0, 0.0])) is None
    sliding = Column("sliding", "friction", "direction")
    assert in_motion(*found([3.0, -3.0, 1.0, 1.0], [1.0, -1.0, 0.0, 0.0], sliding)) is None
